"""The study of an engine's releases: `bodycheck releases` and `bodycheck bisect`.

- `study` compares releases, and `bisection` finds the release that broke a limit. `rows` defines the tables.
- `questions` and `answers` ask releases for results, and cache them. `measurement` is the program that runs in the environment
  of a release.
- `page` and `findings` make the report. `command` and `printing` serve the command line.
"""
