"""Parity: whether engines mean by the file of a robot model what the file says.

- `models`: files of robot models, read by the reader of bodycheck, and the truths of their terms.
- `quantities`, `rows`: the words and the rows of the table.
- `matching`, `conventions`, `stacks`: which joints of an engine are which of the file, how it writes their velocities, and what
  it computes in the order and the conventions of the file.
- `sizes`, `comparing`, `tree`, `numbers`: how far an engine is from the file.
- `diagnosis`: the causes, each recomputed.
- `study`, `motion`, `releases`: all of this for files and engines; what differences do to a motion; changes between releases.
- `command`, `printing`, `page`: the command and what it shows. `collecting` makes tests of files in pytest.
"""
