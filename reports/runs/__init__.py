"""The report of runs: the results of one set, or the differences between several sets.

- `contents`: gathers the whole content of the report, once for all writers, from the following modules:
  `summary` (headline and counts), `findings` (sentences), `matrix` (cases by methods), `scenes` (a case in words),
  `origins` (parts of contact discrepancies), `charts` (plots over time and over time steps), `motions` (animations).
- `comparison`, `differences`: several sets of results in one report.
- `html_report`, `markdown_report`, `results_json`, `plots`: the writers of the report.
- `junit`, `github`: output for CI systems.
"""
