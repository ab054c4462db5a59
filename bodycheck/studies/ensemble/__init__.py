"""The study of ensembles: many members are drawn from one case, and every method is run with each of them.

- `drawing` makes the members: points of sequences, distributions, tables of the user, and the scenes and cases of members.
- `execution` is what worker processes are asked about a chunk of members, and the tables that are made of the chunks' files.
- `findings` reads these tables: counts, quantiles with intervals, sensitivity, maps, ways to fail, and questions in SQL.
- `worst_members` makes the worst members simpler, writes them as case files, and shows them in motion.
- `report` is the page and what it is made of. `command` and `printing` serve the command line.
- `study` plans an ensemble and has it carried out. `header` says in the folder of results what was run.
"""
