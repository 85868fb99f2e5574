# silt - BSD-3-Clause, see LICENSE
"""The public policies of silt, by axis, and what their headers say of them.

Each has a page in the site, made from the `///` block above it. tests/policy_pages_check.py fails where
one lacks a field, and where a header asserts a concept of a policy that is not listed here.
"""

import re
from dataclasses import dataclass, field

import headers

FIELDS = ("Source", "Valid", "Units", "Errors", "Tests")

# axis: (what the axis decides, the page that explains it, {header: names})
AXES = {
    "Contact laws": ("The force between two bodies that touch.", "contact_laws.md", {
        "contact/hertz_mindlin.hpp": ["BasicHertzMindlin"],
        "contact/linear_spring.hpp": ["BasicLinearSpring", "BasicLinearSpringFriction"],
        "contact/hertz_damped.hpp": ["HertzDamped", "KuwabaraKono", "HuntCrossley", "LinearDashpot"],
        "contact/jkr.hpp": ["Jkr"],
        "contact/dcdem.hpp": ["BasicDcdem"],
        "contact/softened.hpp": ["Softened"],
    }),
    "Rolling and twisting": ("The couple that resists rolling and twisting, an option of `Contacts`.", "contact_laws.md", {
        "contact/rolling/epsd.hpp": ["RollingEpsd"],
        "contact/rolling/directional.hpp": ["RollingDirectional"],
        "contact/rolling/viscous.hpp": ["RollingViscous"],
        "contact/rolling/own.hpp": ["RollingOwn"],
        "contact/rolling/twisting.hpp": ["Twisting", "Both"],
    }),
    "Cohesion": ("An attraction that is added to a contact law.", "contact_laws.md", {
        "contact/cohesion/cohesive.hpp": ["Cohesive"],
        "contact/cohesion/dmt.hpp": ["Dmt"],
        "contact/cohesion/area_cohesion.hpp": ["AreaCohesion"],
        "contact/cohesion/van_der_waals.hpp": ["VanDerWaals"],
        "contact/cohesion/capillary_bridge.hpp": ["BasicCapillaryBridge"],
        "contact/cohesion/viscous_bridge.hpp": ["BasicViscousBridge"],
    }),
    "Neighbour searches": ("How pairs of particles that may touch are found.", "search.md", {
        "search/verlet_list.hpp": ["VerletList"],
        "search/hashed_grid.hpp": ["HashedGrid"],
        "search/cell_grid.hpp": ["CellGrid"],
        "search/nbs.hpp": ["Nbs"],
        "search/brute_force.hpp": ["BruteForce"],
        "search/fastest_of.hpp": ["FastestOf"],
    }),
    "Shapes": ("What the particles are.", "shapes.md", {
        "shape/sphere.hpp": ["Sphere"],
        "shape/multi_sphere.hpp": ["MultiSphere"],
        "shape/super_ellipsoid.hpp": ["SuperEllipsoid"],
        "shape/poly_super_ellipsoid.hpp": ["PolySuperEllipsoid"],
        "shape/polyhedron.hpp": ["Polyhedron"],
        "shape/compound.hpp": ["Compound"],
        "shape/mix.hpp": ["Mix"],
    }),
    "Integrators": ("How velocities and positions are advanced, and how bodies turn.", "reference.md", {
        "motion/leapfrog.hpp": ["Leapfrog", "SymplecticEuler"],
        "motion/gear.hpp": ["Gear"],
        "motion/rotation.hpp": ["NoSquish", "Spiral"],
    }),
    "Domains": ("Whether space is open, repeats, or deforms.", "cells.md", {
        "boundary/domain.hpp": ["OpenDomain", "PeriodicBox"],
        "boundary/deforming_box.hpp": ["DeformingBox"],
    }),
    "Precision": ("The floating-point type of the work on pairs.", "performance.md", {
        "core/precision.hpp": ["Double", "Mixed"],
    }),
    "Energy and events": ("What a simulation records of its contacts.", "energy.md", {
        "core/ledger.hpp": ["EnergyLedger"],
        "engine/contact/contact_events.hpp": ["ContactEvents"],
    }),
    "Fluid couplings": ("The fluid around the particles.", "fluid.md", {
        "coupling/no_fluid.hpp": ["NoFluid"],
        "coupling/coupled_flow.hpp": ["BasicCoupledFlow"],
        "coupling/coupled_mesh.hpp": ["CoupledMesh"],
        "coupling/prescribed_flow.hpp": ["PrescribedFlow"],
    }),
    "Drag laws": ("The drag coefficient of particles in a fluid.", "fluid.md", {
        "coupling/drag/lone_sphere.hpp": ["Stokes", "SchillerNaumann", "FreeStream"],
        "coupling/drag/wen_yu.hpp": ["WenYu"],
        "coupling/drag/ergun.hpp": ["Ergun", "Gidaspow", "HuilinGidaspow"],
        "coupling/drag/di_felice.hpp": ["DiFelice", "Rong"],
        "coupling/drag/koch_hill.hpp": ["KochHill"],
        "coupling/drag/beetstra.hpp": ["Beetstra"],
        "coupling/drag/tenneti.hpp": ["Tenneti"],
        "coupling/drag/syamlal_obrien.hpp": ["SyamlalOBrien"],
        "coupling/drag/non_spherical.hpp": ["NonSpherical", "HaiderLevenspiel", "BasicGanser", "Leith", "TranCong",
                                            "BasicHoelzerSommerfeld"],
        "coupling/drag/oriented.hpp": ["OrientedDrag", "SlowEllipsoid", "ZastawnyDrag"],
    }),
    "Other fluid forces": ("Lift, torque, virtual mass and history force.", "fluid.md", {
        "coupling/fluid_force.hpp": ["ShearLift", "SpinLift", "SpinTorque", "VirtualMass"],
        "coupling/drag/oriented.hpp": ["InclinedLift", "ZastawnyLift"],
        "coupling/lift/ellipsoid_torque.hpp": ["EllipsoidTorque"],
        "coupling/unsteady/history_force.hpp": ["HistoryForce"],
    }),
    "Averaging modes": ("How particles and cells of the flow exchange volume and force.", "fluid.md", {
        "coupling/averaging/unresolved.hpp": ["Unresolved"],
        "coupling/averaging/two_grid.hpp": ["TwoGrid"],
        "coupling/averaging/kernel.hpp": ["Kernel"],
        "coupling/averaging/diffusion.hpp": ["Diffusion"],
    }),
    "Turbulence": ("Eddy viscosity of the flow solver.", "fluid.md", {
        "fluid/mixing_length.hpp": ["MixingLength"],
        "fluid/k_epsilon.hpp": ["KEpsilon"],
    }),
    "SPH": ("A liquid with a free surface, and the policies of its scheme.", "sph.md", {
        "sph/sph.hpp": ["Sph"],
        "sph/kernels.hpp": ["WendlandC2", "CubicSpline"],
        "sph/terms.hpp": ["Inviscid", "ArtificialViscosity", "LaminarViscosity", "NoDiffusion", "MolteniColagrossi",
                          "Fourtakas", "NoShifting", "Shifting", "ShiftingByFastest", "MirroredWalls", "DynamicWalls",
                          "ResolvedGrains", "VerletTime", "SymplecticTime",
                          "LeapfrogTime"],
        "sph/turbulence.hpp": ["SpsTurbulence"],
        "sph/herschel_bulkley.hpp": ["HerschelBulkley"],
        "sph/volume.hpp": ["DriftingVolume", "RestoredVolume"],
        "sph/unresolved_grains.hpp": ["UnresolvedGrains"],
    }),
    "Bonds": ("Elastic links between spheres, which may break.", "bonds.md", {
        "bond/concept.hpp": ["Bonds"],
        "bond/parallel_bond.hpp": ["ParallelBond"],
        "bond/contact_bond.hpp": ["ContactBond"],
    }),
    "Breakage": ("Strength, load, fatigue and fragments of particles that break.", "breakage.md", {
        "breakage/breakage.hpp": ["Breakage"],
        "breakage/strength.hpp": ["LogLogisticStrength", "WeibullStrength", "LogNormalStrength", "TavaresStrength",
                                  "VogelPeukertStrength"],
        "breakage/equivalence.hpp": ["HertzEquivalence", "PowerEquivalence", "EnergyEquivalence", "ForceEquivalence"],
        "breakage/fatigue.hpp": ["NoFatigue", "PowerFatigue", "TavaresFatigue"],
        "breakage/sizes.hpp": ["GaudinSchuhmann", "RosinRammler", "Austin", "VogelPeukertSizes"],
        "breakage/t10_sizes.hpp": ["T10Sizes"],
    }),
    "Many processes": ("How space is divided among the ranks of an MPI run.", "ranks.md", {
        "parallel/ranks.hpp": ["Ranks"],
        "parallel/decomposition/slabs.hpp": ["StaticSlabs", "MovingSlabs"],
        "parallel/decomposition/bisection.hpp": ["Bisection"],
        "parallel/decomposition/rcb.hpp": ["Rcb"],
        "parallel/decomposition/hypergraph.hpp": ["Hypergraph"],
        "parallel/decomposition/rebalance.hpp": ["Rebalance"],
    }),
    "Modules": ("Further fields, forces and fluxes of particles.", "modules.md", {
        "module/field.hpp": ["Field"],
        "module/body_force.hpp": ["BodyForce"],
        "module/heat/conduction.hpp": ["HeatConductionBy"],
        "module/heat/surroundings.hpp": ["FrictionHeat", "Heat", "Convection", "Radiation", "RanzMarshall", "Gunn"],
        "module/heat/mutual_radiation.hpp": ["MutualRadiation", "PlaneRadiation"],
        "module/heat/gas_conduction.hpp": ["GasConduction", "PlaneGasConduction"],
        "module/heat/fluid_convection.hpp": ["FluidConvection"],
        "module/charge/charge.hpp": ["Charge"],
        "module/charge/tribo_charge.hpp": ["TriboCharge"],
        "module/wear.hpp": ["Wear", "Archard", "Finnie"],
    }),
}

# Concepts of which a static_assert in a header makes a type a policy.
CONCEPTS = ("ContactLaw RollingModel CohesionModel NeighbourSearch Shape BodyShape SolidShape Integrator RotationIntegrator "
            "FluidCoupling DragLaw LoneBodyLaw OrientedDragLaw FluidForce AveragingMode BondModel Strength Equivalence Fatigue "
            "BreakageFunction Decomposition").split()


@dataclass
class Policy:
    axis: str
    page: str  # of docs/
    declaration: headers.Declaration
    summary: str
    body: str  # of the block, without its fields
    fields: dict
    shared: dict  # fields that stand in a block above several policies of the header
    group: str = ""  # of several policies in one header: what stands behind `@name`
    aliases: list = field(default_factory=list)  # declarations `using Name = ...`

    @property
    def name(self):
        """What users write: of the alias, where the header gives one for the usual case."""
        if self.declaration.name == "BasicCoupledFlow":
            return "CoupledFlow"
        if self.declaration.name.startswith("Basic") or self.declaration.name.endswith("By"):
            return self.aliases[0].name
        return self.declaration.name

    def field(self, word):
        return self.fields.get(word) or self.shared.get(word, "")

    def names(self):
        return {self.name, self.declaration.name} | {a.name for a in self.aliases}


WORDS = r"(Sources?|Valid|Units|Shapes|Errors?|Tests?|Threads|Cost|Deviations|Numerics|Memory|Needs|Limits)"


def split_block(doc):
    """(body, fields) of a doc block: `Word:` begins a field, on its own line or after a sentence."""
    body, fields, word = [], {}, None
    formula = False
    for line in doc.split("\n"):
        if not line.strip():
            if word is None:
                body.append("")
            word = word if line.strip() else None
            formula = False
            continue
        text = line
        if re.match(r"^ {2,}", line) and word is None:
            body.append(line)
            formula = True
            continue
        formula = False
        # A field may begin within a line, after a full stop.
        parts = re.split(r"(?:^|(?<=[.;)] ))(?=" + WORDS + r":(?:\s|$))", text)
        parts = [p for p in parts if p and not re.fullmatch(WORDS, p)]
        for part in parts:
            found = re.match(WORDS + r":\s*(.*)", part)
            if found:
                word = {"Sources": "Source", "Error": "Errors", "Test": "Tests"}.get(found[1], found[1])
                fields[word] = (fields.get(word, "") + " " + found[2]).strip()
            elif word is not None and (line.startswith("  ") or part is parts[0]):
                fields[word] += " " + part.strip()
            else:
                body.append(part)
    return "\n".join(body).strip("\n"), {k: v.strip() for k, v in fields.items()}


def detached_blocks(path):
    """Blocks of `///` in a header that stand above no declaration (a blank line follows), with their lines."""
    lines, blocks, start = path.read_text().split("\n"), [], None
    for number, line in enumerate(lines + [""], 1):
        if line.startswith("///"):
            start = start or number
        elif start:
            if not line.strip() or line.startswith("//") or line.startswith("#") or line.startswith("namespace"):
                blocks.append((start, "\n".join(re.sub(r"^/// ?", "", l) for l in lines[start - 1:number - 1])))
            start = None
    return blocks


# Concepts whose block says what holds for all policies of the axis, where their own does not.
CONTRACTS = {
    "Drag laws": [("coupling/drag/concept.hpp", "DragLaw"), ("coupling/drag/non_spherical.hpp", "LoneBodyLaw"),
                  ("coupling/drag/oriented.hpp", "OrientedDragLaw")],
    "Other fluid forces": [("coupling/drag/oriented.hpp", "OrientedDragLaw")],
    "SPH": [("sph/kernels.hpp", "SphKernel")],
}


def _contract(axis, header):
    """Fields of the concepts that hold for a policy of this header."""
    fields = {}
    contracts = CONTRACTS.get(axis, [])
    for place, name in contracts:
        if place == header or len(contracts) > 1 and place.endswith("/concept.hpp") and axis == "Drag laws":
            block = next(d for d in headers.read(headers.INCLUDE / place) if d.name == name)
            fields |= split_block(block.doc)[1]
    return fields


def all_policies():
    found = []
    for axis, (_, page, members) in AXES.items():
        for header, names in members.items():
            path = headers.INCLUDE / header
            declarations = headers.read(path)
            blocks = detached_blocks(path)
            family = ""  # the last block that tells of several policies by name
            for name in names:
                one = next((d for d in declarations if d.name == name and d.kind == "type"), None)
                if one is None:
                    raise SystemExit(f"docs/site/policies.py names {name}, which is not in include/silt/{header}")
                shared = _contract(axis, header)
                for start, text in blocks:
                    if start < one.line:
                        shared |= split_block(text)[1]
                        if sum(bool(re.search(rf"\b{n}\b", text)) for n in names) > 1:
                            family = text
                doc = one.doc
                if not doc and re.search(rf"\b{name}\b", family):
                    doc = family
                elif sum(bool(re.search(rf"\b{n}\b", doc)) for n in names) > 1:
                    family = doc
                body, fields = split_block(doc)
                aliases = [d for d in declarations if d.kind == "alias" and re.search(rf"= {name}\b", d.text)]
                found.append(Policy(axis, page, one, _summary(name, body, doc is family), body, fields, shared,
                                    _group(path, one.line), aliases))
    return found


def _group(path, line):
    """What the group of a declaration is called: `/// @name ...` above it that no `/// @}` has ended."""
    for text in reversed(path.read_text().split("\n")[:line - 1]):
        if text.startswith("/// @}"):
            return ""
        if text.startswith("/// @name "):
            return text[len("/// @name "):].strip()
    return ""


def _summary(name, body, of_family):
    """The first sentence, or of a family the line of its table that begins with the name."""
    if of_family and (line := re.search(rf"^ +{name}  +(\S.*?)(?:  +\(\d+\))?$", body, re.M)):
        return re.sub(r" {2,}", "; ", line[1])
    words = []
    for text in body.split("\n"):
        if not text.strip() or re.match(r"^ {2,}\S", text):
            break
        words.append(text.strip())
    first = re.split(r"(?<=\.)\s", " ".join(words))[0]
    return first if first.endswith(".") or not first else first.rstrip(":,") + " ..."


def asserted():
    """{name: header} of all types for which a header asserts one of CONCEPTS."""
    found = {}
    for path in sorted(headers.INCLUDE.rglob("*.hpp")):
        for text in re.findall(r"^static_assert\((.*?)\);", path.read_text(), re.S | re.M):
            for concept, name in re.findall(r"(?<!!)\b(\w+)<(\w+)", text):
                if concept in CONCEPTS:
                    found[name] = path.relative_to(headers.INCLUDE).as_posix()
    return found
