"""The script `plgwear`, also as `python -m plgwear_jax`."""

import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line, or say in one line which extra is missing. An interrupt during the start ends it too."""
    try:
        from plgwear_jax import cli

        cli.main()
    except ModuleNotFoundError as error:
        needs = f"needs the extra cli ({error.name} is missing): pip install 'plgwear-jax[cli]', in a clone '.[cli]'"
        print(f"plgwear: {needs}", file=sys.stderr)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
