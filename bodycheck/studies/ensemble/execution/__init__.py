"""How the chunks of an ensemble are carried out.

- `carrying` has the members of a chunk flown and judged, and writes its files. `calls` is what worker processes are asked.
- `truths` is what is stored of the truths of members, and `remarkable` says which runs are kept whole.
- `result_tables` joins the files of chunks to tables, and `gathering` those of several jobs.
"""
