"""Robot models: reading URDF and MJCF files from strangers as data, and writing robot models as such files.

- `elements` reads an XML file of limited size, without document type definitions, as elements that know their lines.
- `urdf`, `urdf_parts`, `attributes` and `orientations` read a URDF as its specification says, which gives the true model.
- `faults` defines violations of the specification in a file.
- `checked` writes the copy of a file that engines get, which refers to no files but copied ones. `mjcf_copy` and `mjcf_meshes`
  make the copy of an MJCF file; `named_files` finds the files that may be read, and removes references to all others.
"""
