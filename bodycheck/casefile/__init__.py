"""Case files: reading, checking and writing them.

- `case` loads a case file and returns a `Case`, or all faults of the file with their lines. This is the entry point.
- `content` defines `Case`, for code that reads no files.
- `finding` finds the case files that a user names: by a name, a path, a folder or a pattern.
- `grammar` defines the keys and the allowed values. `contradictions` checks rules that connect several keys, and that
  expectations can be checked: their engines exist, and their limits can fail.
- `scenes` builds the scene of a case from its tables. `values` defines the types of values, and `axes` the axes of extremes.
- `toml_positions` finds the line and column of a key. `identity` compares the physics of two cases.
- `expectation` holds what a case expects of a method.
- `authoring` writes new case files and the JSON Schema.
"""
