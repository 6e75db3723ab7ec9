"""Files beside the packages: what is in them, and how to know that they are whole."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

SBOM = Path(__file__).resolve().parents[2] / "scripts/lib/sbom.py"
HEADERS = "libeigen3-dev 3.4.0-4\nlibexpected-dev 1.0.0~dfsg-2\n"


def deb(folder: Path, name: str, depends: str, arch: str = "amd64") -> Path:
    control = folder / f"{name}-{arch}" / "DEBIAN"
    control.mkdir(parents=True)
    (control / "control").write_text(
        f"Package: {name}\nVersion: 0.2.0-1\nArchitecture: {arch}\nMaintainer: n <e>\n"
        f"Depends: {depends}\nDescription: d\n"
    )
    subprocess.run(
        ["dpkg-deb", "--root-owner-group", "--build", control.parent, folder / f"{name}.deb"],
        check=True,
        capture_output=True,
    )
    return folder / f"{name}.deb"


@pytest.fixture
def packages(tmp_path: Path) -> Path:
    folder = tmp_path / "packages"
    folder.mkdir()
    deb(tmp_path, "rc10d", "libc6 (>= 2.36), libyaml-cpp0.7 (>= 0.7.0)").rename(
        folder / "rc10d.deb"
    )
    with zipfile.ZipFile(folder / "rc10-0.2.0-py3-none-any.whl", "w") as wheel:
        wheel.writestr(
            "rc10-0.2.0.dist-info/METADATA",
            "Name: rc10\nVersion: 0.2.0\nRequires-Dist: lcm<2,>=1.5\n"
            "Requires-Dist: numpy; extra == 'export'\n",
        )
    (tmp_path / "headers").write_text(HEADERS)
    return folder


def bill_of(folder: Path) -> dict[str, Any]:
    subprocess.run(
        [sys.executable, SBOM, folder, folder.parent / "headers"],
        check=True,
        env={"SOURCE_DATE_EPOCH": "1700000000", "PATH": "/usr/bin:/bin"},
    )
    bill: dict[str, Any] = json.loads((folder / "rc10d.spdx.json").read_text())
    return bill


def test_the_bill_names_what_is_shipped_and_all_it_depends_on(packages: Path) -> None:
    bill = bill_of(packages)
    assert (bill["spdxVersion"], bill["creationInfo"]["created"]) == (
        "SPDX-2.3",
        "2023-11-14T22:13:20Z",
    )
    by_id = {package["SPDXID"]: package for package in bill["packages"]}
    assert len(by_id) == len(bill["packages"])
    named = {
        (by_id.get(r["spdxElementId"], {}).get("name"), r["relationshipType"], by_id[other]["name"])
        for r in bill["relationships"]
        if (other := r["relatedSpdxElement"]) in by_id
    }
    assert named == {
        (None, "DESCRIBES", "rc10d"),
        (None, "DESCRIBES", "rc10"),
        ("rc10d", "DEPENDS_ON", "libc6"),
        ("rc10d", "DEPENDS_ON", "libyaml-cpp0.7"),
        ("rc10", "DEPENDS_ON", "lcm"),
        ("numpy", "OPTIONAL_DEPENDENCY_OF", "rc10"),
        ("libeigen3-dev", "BUILD_DEPENDENCY_OF", "rc10d"),
        ("libexpected-dev", "BUILD_DEPENDENCY_OF", "rc10d"),
    }
    shipped = next(package for package in bill["packages"] if package["name"] == "rc10d")
    digest = hashlib.sha256((packages / "rc10d.deb").read_bytes()).hexdigest()
    assert shipped["checksums"] == [{"algorithm": "SHA256", "checksumValue": digest}]
    assert shipped["versionInfo"] == "0.2.0-1"


def test_each_architecture_is_in_the_bill_with_what_it_depends_on(
    packages: Path, tmp_path: Path
) -> None:
    deb(tmp_path, "rc10d", "libc6 (>= 2.36)", arch="arm64").rename(packages / "rc10d_arm64.deb")
    deb(tmp_path, "rc10-dev", "rc10d (= 0.2.0-1)", arch="arm64").rename(packages / "rc10-dev.deb")
    bill = bill_of(packages)
    files = {p["packageFileName"]: p["SPDXID"] for p in bill["packages"] if "packageFileName" in p}
    assert sorted(files) == [
        "rc10-0.2.0-py3-none-any.whl",
        "rc10-dev.deb",
        "rc10d.deb",
        "rc10d_arm64.deb",
    ]
    assert {
        "spdxElementId": files["rc10-dev.deb"],
        "relationshipType": "DEPENDS_ON",
        "relatedSpdxElement": files["rc10d_arm64.deb"],
    } in bill["relationships"]


def test_the_checksums_find_a_file_that_was_changed_the_bill_too(packages: Path) -> None:
    bill_of(packages)
    check = ["sha256sum", "--check", "--strict", "SHA256SUMS"]
    good = subprocess.run(check, cwd=packages, capture_output=True, text=True, check=False)
    assert (good.returncode, good.stdout.count(": OK")) == (0, 3)
    for name in ("rc10d.deb", "rc10-0.2.0-py3-none-any.whl", "rc10d.spdx.json"):
        file = packages / name
        before = file.read_bytes()
        file.write_bytes(before + b" ")
        bad = subprocess.run(check, cwd=packages, capture_output=True, text=True, check=False)
        assert bad.returncode == 1
        assert f"{name}: FAILED" in bad.stdout
        file.write_bytes(before)


def test_the_same_packages_have_the_same_bill(packages: Path) -> None:
    bill_of(packages)
    first = (packages / "rc10d.spdx.json").read_bytes()
    bill_of(packages)
    assert (packages / "rc10d.spdx.json").read_bytes() == first
