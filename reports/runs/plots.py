"""The plots of a report of runs, to be written as files."""

from collections.abc import Iterator

from bodycheck.reports.charts import Spec
from bodycheck.reports.plot_files import standing_alone
from bodycheck.reports.runs.charts import joint_curves
from bodycheck.reports.runs.charts.time_charts import joints, momentum, over_time, readings
from bodycheck.reports.runs.contents import Contents


def of_runs(contents: Contents) -> Iterator[tuple[str, Spec]]:
    """Yield the plots of a report of runs as unique names and specifications."""
    for section in contents.sections:
        methods = {row["method"] for row in section.curves.datasets["series"]}
        lines = [line for line in contents.lines if line.label in methods]
        floors = {name for row in section.curves.datasets["floor"] for name, values in row.items() if values}
        plots = {
            quantity.name: (quantity.title, over_time(quantity, lines))
            for quantity in contents.plotted
            if quantity.name in section.curves.drawn
        }
        if section.curves.momentum:
            for frame, where in (("body", "in the body"), ("inertial", "in the inertial frame")):
                plots[f"momentum_{frame}"] = (f"Angular momentum of the truth, {where}", momentum(frame))
        for kind, title in joint_curves.TITLES.items():
            if kind in section.curves.joints:
                plots[f"joints_{kind}"] = (title, joints(kind))
        for number, (title, _) in section.curves.sensors.items():
            plots[f"readings_{number}"] = (title, readings(number))
        for name, (description, chart) in plots.items():
            floor = "; grey: the truth's own error" if name in floors else ""
            complete = chart | {"datasets": section.curves.datasets}
            rows = 1 if name.startswith(("momentum", "joints", "readings")) else len(lines)
            yield f"{section.name}-{name}", standing_alone(complete, section.title, description + floor, rows)
        for drawn in section.steps.charts:
            description = f"{drawn.title} over the time step"
            yield f"{section.name}-{description}", standing_alone(drawn.specification, section.title, description, 1)
        for drawn in section.origins.charts if section.origins else ():
            yield f"{section.name}-{drawn.title}", standing_alone(drawn.specification, section.title, drawn.title, 1)
