"""`python -m plgwear_jax` is the script `plgwear`."""

from plgwear_jax.cli import main

if __name__ == "__main__":
    main()
