"""The study of accuracy and cost over time steps: `bodycheck tradeoff`.

- `study` plans the runs, measures costs and observes orders. `batches` steps many turned copies of a case at once.
- `measurements` finds the Pareto front of a case. `page`, `batch_page`, `findings` and `diagram` make the report.
- `command` and `printing` serve the command line, and `interface` is the Python function.
"""
