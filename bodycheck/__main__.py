"""`python -m bodycheck`."""

from bodycheck.commands.command_line import main

if __name__ == "__main__":
    main()
