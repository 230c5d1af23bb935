"""A pipeline of tiny stages, with DVC itself, for the commands that run one."""

import subprocess
import sys

DVC = """stages:
  config:
    cmd: python stage.py config
    deps: [params.yaml, stage.py]
    outs: [data/config]
  diagnose:
    cmd: python stage.py diagnose
    deps: [data/config]
    outs: [data/diagnosis]
  report:
    cmd: python stage.py report
    deps: [data/diagnosis]
    outs: [reports/index.html]
  aside:
    cmd: python stage.py aside
    deps: [stage.py]
    outs: [data/aside]
"""
STAGE = """import os, pathlib, sys, time, yaml
name = sys.argv[1]
chosen = yaml.safe_load(open("params.yaml"))["overrides"]
print(f"{name} speaks")
if f"{name}.bad=1" in chosen:
    print(f"{name}: bad may not be 1", file=sys.stderr)
    sys.exit(2)
if name == "diagnose" and "bug=1" in chosen:
    raise ZeroDivisionError("ours")
if name == "diagnose" and "slow=1" in chosen:
    pathlib.Path("asleep").write_text(str(os.getpid()))
    time.sleep(60)
if name == "report":
    pathlib.Path("reports").mkdir(exist_ok=True)
    pathlib.Path("reports/index.html").write_text("page")
else:
    folder = pathlib.Path("data", name.replace("diagnose", "diagnosis"))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{folder.name}.json").write_text('{"sentence": "Nothing is missing."}')
    (folder / "choices").write_text(open("params.yaml").read())
"""


def toy(root, persist=False):
    """The pipeline in a folder; `persist` keeps data/config where its stage runs anew."""
    stages = DVC.replace("python stage", f"{sys.executable} stage")
    if persist:
        stages = stages.replace("[data/config]\n  diag", "[{data/config: {persist: true}}]\n  diag")
        assert "persist" in stages
    (root / "pipeline").mkdir()
    (root / "dvc.yaml").write_text(stages)
    (root / "stage.py").write_text(STAGE)
    (root / "params.yaml").write_text("# choices\noverrides: []\n")
    subprocess.run(["git", "init", "-q"], cwd=root, check=True)
    subprocess.run([sys.executable, "-m", "dvc", "init", "-q"], cwd=root, check=True)
    return root
