"""Files: the one way in which results are written, and the one way in which files from strangers are read.

`writing` writes files whole or not at all, through no symbolic link. `reading` reads regular files of a limited size. A folder
of results may come from anyone, so neither follows a symbolic link inside it. `temporary` has folders that a command needs only
while it runs.
"""
