"""The report of runs: what one set of results shows, or how several sets differ.

- `contents`: gathers everything that the report says, once for all writers, from the following:
  `summary` (headline and counts), `findings` (sentences), `matrix` (cases by methods), `scenes` (a case in words),
  `origins` (parts of contact discrepancies), `charts` (plots over time and over time steps), `motions` (animations).
- `comparison`, `differences`: several sets of results in one report.
- `html_report`, `markdown_report`, `results_json`, `plots`: the writers of the report.
- `junit`, `github`: output for CI systems.
"""
