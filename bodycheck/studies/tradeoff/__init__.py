"""The study of accuracy and cost over time steps: `bodycheck tradeoff`.

- `study` plans the runs, measures costs and observes orders. `ladder` chooses the time steps of a case.
- `front` finds the Pareto front.
- `page`, `findings`, `diagram` and `measurements` make the report. `command` and `printing` serve the command line.
"""
