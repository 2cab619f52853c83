"""An analysis as a notebook shows it: headed by what was found, as every report is."""

from __future__ import annotations

from mbsym import analysis


class Analysis(analysis.Analysis):
    """What ``mbsym.load`` gives; what a notebook shows of it derives its problems."""

    def _repr_html_(self) -> str:
        from mbsym.report.html.report import finding_html

        return finding_html(self)
