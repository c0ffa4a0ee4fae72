"""A cluster whose machines do not share their files: a worker in a mount namespace of its own."""

from __future__ import annotations

import shlex
import subprocess
import sys
import warnings
from collections import Counter

import numpy as np
import pytest
from distributed import Client, LocalCluster
from numpy.testing import assert_array_equal

import fastlink as fl
from fastlink.io.writer import Writer


@pytest.mark.stress
@pytest.mark.filterwarnings("default:NOT TESTED")
@pytest.mark.parametrize("layout", ["curves", "maps"])
def test_a_worker_with_another_file_system_sends_its_results_back(tmp_path, monkeypatch, layout):
    folder, designs = tmp_path / "shared", Counter()
    folder.mkdir()
    apart = f"mount --make-rprivate / && mount -t tmpfs none {shlex.quote(str(folder))}"
    if subprocess.run(
        ["unshare", "--mount", "bash", "-c", apart], check=False, capture_output=True
    ).returncode:
        warnings.warn("NOT TESTED: no mount namespace can be made here", stacklevel=1)
        pytest.skip("no mount namespace can be made")
    record, merge = Writer.record, Writer.merge

    def sent_back(self, start, stop):
        record(self, start, stop)
        designs["sent back"] += stop - start

    def written(self, report):
        merge(self, report)
        designs["written"] += sum(stop - start for start, stop in report.ranges)

    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.2, 200), a3=np.linspace(0.7, 0.9, 200), a4=1.0, omega1=2.0)
    request = "planar_4r", space, ["omega4_max", "theta4"]
    options = {"theta1": 36, "verify": 0, "layout": layout}
    worker = f"{shlex.quote(sys.executable)} -m distributed.cli.dask_worker --nthreads 1 --no-dashboard"
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
        subprocess.Popen(
            ["unshare", "--mount", "bash", "-c", f"{apart} && exec {worker} {cluster.scheduler_address}"]
        ) as process,
    ):
        try:
            client.wait_for_workers(2, timeout=120)
            with monkeypatch.context() as patch:
                patch.setattr(Writer, "record", sent_back)
                patch.setattr(Writer, "merge", written)
                fl.sweep(*request, to=folder / "m.h5", client=client, **options).close()
        finally:
            process.terminate()
    assert designs["sent back"] + designs["written"] == space.size
    assert min(designs["sent back"], designs["written"]) > 0
    assert fl.check(folder / "m.h5")
    with fl.open(folder / "m.h5") as found, fl.sweep(*request, **options) as expected:
        for name in expected:
            assert_array_equal(found[name], expected[name], err_msg=name)
