"""An MJCF file for a case: one body (`link`), or all bodies and joints as tables (`tree`), and all other parts (`features`).

- `file` puts the file together with those that it includes; `schema` has the attributes that MuJoCo allows.
- `settings` and `options` read what belongs to the whole file, `parts` the elements of a body with frames and default classes.
- `inertia`, `geoms`, `solids`, `meshes` and `mesh_files` compute the mass properties of a body.
- `joints`, `springs`, `equalities` and `keyframes` read what moves bodies; `carriers` defines what `tree` collects.
"""
