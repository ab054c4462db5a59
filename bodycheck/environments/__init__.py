"""Environments: other releases of the engines, each installed apart, in which bodycheck runs as it does here.

An environment is a virtual environment that holds one release of an engine's package and the packages that it depends on.
Everything else, bodycheck itself included, is imported from the running interpreter, so that the same code runs in all
environments and no copy of it can become outdated.

- `environments`: the environments in the cache folder: obtain, list, run and remove them.
- `making`: how one environment is made in an empty folder and checked.
- `installation`: virtual environments and packages by uv, from the sources for which pip is configured.
- `privacy`: who can change a folder of the cache.
- `subprocesses`: programs that end with this process.
"""
