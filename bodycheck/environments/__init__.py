"""Environments: other releases of the engines, each installed separately, in which bodycheck runs as in its own interpreter.

An environment is a virtual environment that holds one release of an engine's package and the packages that it depends on.
Everything else, bodycheck itself included, is imported from the running interpreter, so that the same code runs in all
environments and no copy of it can become outdated.

- `environments` obtains, lists, measures, runs and removes the environments in the cache folder.
- `making` makes one environment in an empty folder and checks it.
- `installation` installs virtual environments and packages with uv, from the package sources configured for pip.
- `privacy` checks who can change a folder of the cache.
- `subprocesses` runs programs that end with this process.
"""
