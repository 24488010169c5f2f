"""The command `plgwear schema`: the JSON schema of scenes, for editors."""

import json

import typer

__all__ = ["schema"]


def schema() -> None:
    """Print the JSON schema of a scene, with which editors check and complete it.

    Example: plgwear schema > scene.schema.json
    """
    from plgwear_jax import scene

    typer.echo(json.dumps(scene.json_schema(), indent=2))
