"""The commands of the command line that are not studies.

`command_line` registers all commands, turns errors into messages and exit codes, and is the entry point. Every other module
contains the command, or the few related commands, of its name; `authoring` contains `validate`, `new`, `schema` and `expect`,
and `listing` contains `cases` and `engines`. `saved` reads folders of saved results for `bodycheck report`. The commands of
studies are the modules `command` in the folders of `bodycheck.studies`.
"""
