#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Every public policy has a doc block from which its page in the site is made.

The policies are listed in docs/site/policies.py. The block must begin with a sentence and have the fields
Source, Valid, Units, Errors and Tests; they may stand in the block of a family or of the axis' concept.
Files that headers name must exist. A type for which a header asserts the concept of an axis must be listed.
`policy_pages_check.py --self-test` shows that each of these checks can fail.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs" / "site"))
import policies  # noqa: E402


def faults_of(policy):
    where = f"include/{policy.declaration.header}:{policy.declaration.line}: {policy.declaration.name}"
    faults = []
    if not policy.body.strip():
        faults.append(f"{where} has no doc block; put a `///` block above it that says what it is")
    for word in policies.FIELDS:
        text = policy.field(word)
        if not text:
            faults.append(f"{where} does not say `{word}:` in its doc block")
    return faults


def lost_paths(header, text):
    """Files that the comments of a header name and that do not exist."""
    joined = re.sub(r"\n\s*///? ?", " ", text)
    named = set(re.findall(r"\b(?:tests|docs|examples|benchmarks)/[\w/]+\.(?:cpp|md|sh|py|hpp)\b", joined))
    return [f"{header} names {path}, which is not there" for path in sorted(named) if not (ROOT / path).exists()]


def unlisted(asserted, listed):
    return [f"include/silt/{header}: {name} is asserted to be a policy, but docs/site/policies.py does not list it"
            for name, header in asserted.items() if name not in listed]


def self_test():
    import copy
    one = next(p for p in policies.all_policies() if p.name == "HertzMindlin")
    assert not faults_of(one)
    for word in policies.FIELDS:
        without = copy.deepcopy(one)
        without.fields.pop(word)
        assert any(f"`{word}:`" in fault for fault in faults_of(without)), word
    bare = copy.deepcopy(one)
    bare.body = ""
    assert any("no doc block" in fault for fault in faults_of(bare))
    assert lost_paths("a.hpp", "/// Tests:  tests/search/\n") == []
    assert lost_paths("a.hpp", "/// Tests:\n/// tests/search/not_there.cpp")
    assert unlisted({"NewLaw": "contact/new_law.hpp"}, {"HertzMindlin"})
    assert "HertzMindlin" in policies.asserted() and "Beetstra" in policies.asserted()


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    every = policies.all_policies()
    listed = set().union(*(p.names() for p in every))
    faults = [fault for p in every for fault in faults_of(p)] + unlisted(policies.asserted(), listed)
    for path in sorted((ROOT / "include").rglob("*.hpp")):
        faults += lost_paths(path.relative_to(ROOT), path.read_text())
    print("\n".join(faults) if faults else f"{len(every)} policies, each with its doc block")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
