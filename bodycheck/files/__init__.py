"""Files: the single way to write results, and the single way to read files from strangers.

`writing` writes files whole or not at all, through no symbolic link. `reading` reads regular files of a limited size. A folder
of results may come from anyone, so neither module follows a symbolic link inside it. `temporary` provides folders that a
command needs only while it runs. `columns` converts columns of Arrow tables.
"""
