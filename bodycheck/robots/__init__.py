"""Robot models: URDF and MJCF files from strangers, read as data, and robot models written as such files.

- `elements`: an XML file as elements that know their lines, of a limited size and without document type definitions.
- `urdf`, `urdf_parts`, `attributes`, `orientations`: a URDF as its specification says, which is the truth of it.
- `faults`: what the specification refuses in a file.
- `checked`: the copy of a file that engines get, in which nothing leads to another file. `mjcf_copy` and `mjcf_meshes` make
  that of an MJCF file; `named_files` finds the files that it may read, and takes out what names files.
"""
