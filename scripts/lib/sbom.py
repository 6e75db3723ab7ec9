#!/usr/bin/env python3
"""The bill of materials of what scripts/package.sh made, in SPDX 2.3, and SHA256SUMS.

    sbom.py FOLDER BUILD_PACKAGES    the folder of .deb and .whl files; a file of "name version", a
                                     line for each Debian package whose headers the build took

Files of the same content make the same text: its time is $SOURCE_DATE_EPOCH.
"""

from __future__ import annotations

import datetime as dt
import hashlib
import json
import os
import re
import subprocess
import sys
import zipfile
from email.message import Message
from email.parser import HeaderParser
from pathlib import Path

DEPENDENCY = re.compile(r"([a-z0-9][a-z0-9.+-]*)(?::\w+)?\s*(?:\(([^)]*)\))?")
REQUIREMENT = re.compile(r"([A-Za-z0-9][A-Za-z0-9._-]*)\s*([^;]*)(;.*extra.*)?")
UNKNOWN = "NOASSERTION"


def sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def spdx_id(*words: str) -> str:
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", "-".join(words))


class Bill:
    """Packages and what they depend on, each once."""

    def __init__(self) -> None:
        self.packages: dict[str, dict[str, object]] = {}
        self.relations: list[dict[str, str]] = []

    def add(self, name: str, version: str, purl: str, **more: object) -> str:
        key = spdx_id("Package", purl.partition(":")[2].partition("/")[0], name)
        entry: dict[str, object] = {
            "SPDXID": key,
            "name": name,
            "downloadLocation": UNKNOWN,
            "filesAnalyzed": False,
            "licenseConcluded": UNKNOWN,
            "licenseDeclared": UNKNOWN,
            "copyrightText": UNKNOWN,
            "externalRefs": [
                {
                    "referenceCategory": "PACKAGE-MANAGER",
                    "referenceType": "purl",
                    "referenceLocator": purl,
                }
            ],
            **({"versionInfo": version} if version else {}),
            **more,
        }
        key = str(entry["SPDXID"])
        self.packages.setdefault(key, entry)
        return key

    def relate(self, subject: str, kind: str, other: str) -> None:
        relation = {"spdxElementId": subject, "relationshipType": kind, "relatedSpdxElement": other}
        if relation not in self.relations:
            self.relations.append(relation)


def shipped(bill: Bill, file: Path, name: str, version: str, purl: str) -> str:
    # By its file: there may be one for each architecture, and packages of other versions.
    key = bill.add(
        name,
        version,
        purl,
        SPDXID=spdx_id("File", file.name),
        packageFileName=file.name,
        licenseDeclared="Apache-2.0",
        copyrightText="2026 the authors of rc10d",
        checksums=[{"algorithm": "SHA256", "checksumValue": sha256(file)}],
    )
    bill.relate("SPDXRef-DOCUMENT", "DESCRIBES", key)
    return key


def fields_of(deb: Path) -> Message:
    done = subprocess.run(["dpkg-deb", "--field", deb], capture_output=True, text=True, check=True)
    return HeaderParser().parsestr(done.stdout)


def add_debs(bill: Bill, files: list[Path]) -> list[str]:
    """Debian packages and those that they depend on, with their conditions as versions."""
    fields = [fields_of(file) for file in files]
    keys: dict[tuple[str, str], str] = {}
    for file, of in zip(files, fields, strict=True):
        name, version, arch = of["Package"], of["Version"], of["Architecture"]
        purl = f"pkg:deb/debian/{name}@{version}?arch={arch}"
        keys[name, arch] = shipped(bill, file, name, version, purl)
    for of in fields:
        name, arch = of["Package"], of["Architecture"]
        for word in of.get("Depends", "").split(","):
            if found := DEPENDENCY.match(word.strip()):
                other = keys.get((found[1], arch)) or bill.add(
                    found[1], found[2] or "", f"pkg:deb/debian/{found[1]}"
                )
                bill.relate(keys[name, arch], "DEPENDS_ON", other)
    return list(keys.values())


def add_wheel(bill: Bill, file: Path) -> None:
    """A Python wheel and what it requires; what an extra requires is optional."""
    with zipfile.ZipFile(file) as archive:
        inside = next(n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        fields = HeaderParser().parsestr(archive.read(inside).decode())
    name, version = fields["Name"], fields["Version"]
    key = shipped(bill, file, name, version, f"pkg:pypi/{name}@{version}")
    for word in fields.get_all("Requires-Dist", []):
        found = REQUIREMENT.match(word)
        if found:
            needed = bill.add(found[1], found[2].strip(), f"pkg:pypi/{found[1].lower()}")
            if found[3]:
                bill.relate(needed, "OPTIONAL_DEPENDENCY_OF", key)
            else:
                bill.relate(key, "DEPENDS_ON", needed)


def document(folder: Path, build_packages: Path) -> dict[str, object]:
    bill = Bill()
    programs = add_debs(bill, sorted(folder.glob("*.deb")))
    if not programs:
        sys.exit(f"sbom: there is no package in {folder}")
    for file in sorted(folder.glob("*.whl")):
        add_wheel(bill, file)
    # Their code is in the programs: header-only libraries and archives have no other trace there.
    for line in sorted(build_packages.read_text(encoding="utf-8").splitlines()):
        name, version = line.split()
        built = bill.add(name, version, f"pkg:deb/debian/{name}@{version}")
        for program in programs:
            bill.relate(built, "BUILD_DEPENDENCY_OF", program)
    time = dt.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), dt.timezone.utc)
    sums = "".join(sha256(file) for file in sorted([*folder.glob("*.deb"), *folder.glob("*.whl")]))
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": "rc10d",
        "documentNamespace": "https://spdx.org/spdxdocs/rc10d-"
        + hashlib.sha256(sums.encode()).hexdigest(),
        "creationInfo": {
            "created": time.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "creators": ["Tool: rc10d-scripts-lib-sbom.py"],
        },
        "packages": list(bill.packages.values()),
        "relationships": bill.relations,
    }


def main() -> None:
    folder, build_packages = Path(sys.argv[1]), Path(sys.argv[2])
    bill = folder / "rc10d.spdx.json"
    bill.write_text(json.dumps(document(folder, build_packages), indent=1) + "\n", encoding="utf-8")
    files = sorted([*folder.glob("*.deb"), *folder.glob("*.whl"), bill])
    sums = "".join(f"{sha256(file)}  {file.name}\n" for file in files)
    (folder / "SHA256SUMS").write_text(sums, encoding="utf-8")


if __name__ == "__main__":
    main()
