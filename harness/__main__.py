"""`python -m bodycheck`."""

from bodycheck.command_line import main

if __name__ == "__main__":
    main()
