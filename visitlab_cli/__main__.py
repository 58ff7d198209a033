"""`python -m visitlab_cli`."""

from visitlab_cli.cli import main

if __name__ == "__main__":
    main()
