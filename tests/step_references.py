#!/usr/bin/env python3
"""Random STEP assemblies whose parts are files of their own.

Writes assemblies of boxes as STEP: parts in the file itself, beside it, in folders below, and in assemblies that are files
too; some of them missing, damaged, of another format, or in a folder above. Compares what `sdm info` says of each with
what was written: the volume and the number of boxes, or an error that names a file that cannot be had.
  tests/step_references.py SDM [--cases N] [--first SEED]
"""

import json
import random
import subprocess
import tempfile
from pathlib import Path

import random_cases


class Step:
    """A STEP file (AP214) in millimetres."""

    def __init__(self) -> None:
        self.lines: list = []
        self.context = self.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{self.context})")
        units = [self.add(f"( {kind} NAMED_UNIT(*) {unit} )") for kind, unit in (
            ("LENGTH_UNIT()", "SI_UNIT(.MILLI.,.METRE.)"), ("PLANE_ANGLE_UNIT()", "SI_UNIT($,.RADIAN.)"),
            ("SOLID_ANGLE_UNIT()", "SI_UNIT($,.STERADIAN.)"))]
        near = self.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{units[0]},'distance_accuracy_value','')")
        self.space = self.add("( GEOMETRIC_REPRESENTATION_CONTEXT(3) "
                              f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({near})) GLOBAL_UNIT_ASSIGNED_CONTEXT(({','.join(units)})) "
                              "REPRESENTATION_CONTEXT('','') )")
        self.origin = self.placement((0, 0, 0))

    def add(self, entity: str) -> str:
        self.lines.append(entity)
        return f"#{len(self.lines)}"

    def direction(self, vector: tuple) -> str:
        return self.add(f"DIRECTION('',({','.join(f'{float(x)}' for x in vector)}))")

    def point(self, p: tuple) -> str:
        return self.add(f"CARTESIAN_POINT('',({','.join(f'{float(x)}' for x in p)}))")

    def placement(self, p: tuple, z: tuple = (0, 0, 1), x: tuple = (1, 0, 0)) -> str:
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(p)},{self.direction(z)},{self.direction(x)})")

    def box(self, sizes: tuple) -> str:
        """A solid from (0, 0, 0) on."""
        corners = [tuple(sizes[k] if i >> k & 1 else 0 for k in range(3)) for i in range(8)]
        points = [self.point(corner) for corner in corners]
        faces = []
        for axis in range(3):
            u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
            for side in (0, 1):
                first = side << axis
                loop = [first, first + u, first + u + v, first + v]
                if side == 0:
                    loop.reverse()
                normal = tuple((1 if side else -1) if k == axis else 0 for k in range(3))
                across = tuple(1 if k == (axis + 1) % 3 else 0 for k in range(3))
                polygon = self.add(f"POLY_LOOP('',({','.join(points[i] for i in loop)}))")
                bound = self.add(f"FACE_OUTER_BOUND('',{polygon},.T.)")
                plane = self.add(f"PLANE('',{self.placement(corners[first], normal, across)})")
                faces.append(self.add(f"FACE_SURFACE('',({bound}),{plane},.T.)"))
        shell = self.add(f"CLOSED_SHELL('',({','.join(faces)}))")
        return self.add(f"FACETED_BREP('',{shell})")

    def product(self, name: str, kind: str, items: list) -> tuple:
        """A product definition, and the representation of its shape."""
        discipline = self.add(f"PRODUCT_CONTEXT('',{self.context},'mechanical')")
        product = self.add(f"PRODUCT('{name}','{name}','',({discipline}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        stage = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{self.context},'design')")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{formation},{stage})")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        representation = self.add(f"{kind}('',({','.join([self.origin, *items])}),{self.space})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{representation})")
        return definition, representation

    def place(self, parent: tuple, child: tuple, at: str) -> None:
        transform = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',{self.origin},{at})")
        relation = self.add(f"( REPRESENTATION_RELATIONSHIP('','',{child[1]},{parent[1]}) "
                            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({transform}) SHAPE_REPRESENTATION_RELATIONSHIP() )")
        usage = self.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{len(self.lines)}','','',{parent[0]},{child[0]},$)")
        placed = self.add(f"PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',{usage})")
        self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{placed})")

    def document(self, product: tuple, name: str, form: str, says_so: bool) -> None:
        """The file of a part, whose format OpenCASCADE sees only in a representation of a shape."""
        kind = self.add("DOCUMENT_TYPE('')")
        file = self.add(f"DOCUMENT_FILE('{name}','',$,{kind},'',$)")
        self.add(f"APPLIED_DOCUMENT_REFERENCE({file},'',({product[0]}))")
        item = self.add(f"DESCRIPTIVE_REPRESENTATION_ITEM('data format','{form}')")
        context = self.add("REPRESENTATION_CONTEXT('','document parameters')")
        representation = self.add(f"{'SHAPE_' if says_so else ''}REPRESENTATION('document format',({item}),{context})")
        definition = self.add(f"PROPERTY_DEFINITION('document property','',{file})")
        self.add(f"PROPERTY_DEFINITION_REPRESENTATION({definition},{representation})")

    def write(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
                        "FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');\n"
                        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
                        + "".join(f"#{i + 1} = {line};\n" for i, line in enumerate(self.lines))
                        + "ENDSEC;\nEND-ISO-10303-21;\n")


class Case:
    def __init__(self, folder: Path, seed: int) -> None:
        self.dice, self.folder = random.Random(seed), folder
        self.faults: list = []  # texts, one of which the error has
        self.notes: list = []
        self.files = 0
        self.is_faulty = self.dice.random() < 0.5
        self.shared: dict = {}  # the volume of shared.stp by its folder
        self.volume, self.boxes = self.assembly(folder / "main.step", 0)
        if len(self.shared) > 1:
            self.faults.append("shared.stp")  # files of one name in several folders are not told apart

    def sizes(self) -> tuple:
        return tuple(round(self.dice.uniform(1, 3), 2) for _ in range(3))

    def assembly(self, path: Path, depth: int) -> tuple:
        """Writes an assembly; returns its volume, and the number of boxes. They are 1000 apart, 10 in those below."""
        dice, step = self.dice, Step()
        count = dice.randrange(1, 5)
        places = [step.placement((k * 1000 / 10 ** depth, 0, 0)) for k in range(count)]
        volume = boxes = 0
        children, known = [], []
        for _ in range(count):
            if known and dice.random() < 0.3:  # another instance
                child, of_child = dice.choice(known)
            else:
                child, of_child = self.child(step, path.parent, depth)
                known.append((child, of_child))
            children.append(child)
            volume, boxes = volume + of_child[0], boxes + of_child[1]
        parent = step.product(path.stem, "SHAPE_REPRESENTATION", places)
        for child, place in zip(children, places):
            step.place(parent, child, place)
        step.write(path)
        return volume, boxes

    def child(self, step: Step, folder: Path, depth: int) -> tuple:
        dice = self.dice
        self.files += 1
        name = f"p{self.files}"
        if dice.random() < 0.3:
            a, b, c = self.sizes()
            child = step.product(name, "FACETED_BREP_SHAPE_REPRESENTATION", [step.box((a, b, c))])
            if dice.random() < 0.3:
                self.document(step, child, folder, name)
            return child, (a * b * c, 1)
        child = step.product(name, "SHAPE_REPRESENTATION", [])
        if dice.random() < 0.1:
            step.document(child, "shared.stp", "STEP AP214", False)
            if folder not in self.shared:
                self.shared[folder] = self.part(folder / "shared.stp")
            return child, self.shared[folder]
        place = dice.choice(["", "", "sub/", f"{name}/deep/"])
        file, form = f"{place}{name}.{dice.choice(['stp', 'step', 'STEP'])}", dice.choice(["STEP AP214", "STEP AP203"])
        says_so = dice.random() < 0.5
        is_faulty = self.is_faulty and dice.random() < 0.3
        fault = dice.choice(["missing", "damaged", "format", "above"]) if is_faulty else ""
        if fault == "format":
            file, form = f"{place}{name}.prt", "NX"
        path = folder / file
        if fault == "above":
            file = "../" + file
            path = folder / file
        if fault:
            self.faults.append(Path(file).name)
        step.document(child, file, form, says_so)
        if fault == "missing" or (fault == "format" and dice.random() < 0.5):
            return child, (0, 0)
        if fault in ("damaged", "format"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(dice.choice(["", "binary", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"]))
            return child, (0, 0)
        if depth < 2 and dice.random() < 0.3:
            return child, self.assembly(path, depth + 1)
        return child, self.part(path)

    def part(self, path: Path) -> tuple:
        part, (a, b, c) = Step(), self.sizes()
        part.product(path.stem, "FACETED_BREP_SHAPE_REPRESENTATION", [part.box((a, b, c))])
        part.write(path)
        return a * b * c, 1

    def document(self, step: Step, child: tuple, folder: Path, name: str) -> None:
        """A file that has no shape that the part lacks."""
        file, form = self.dice.choice([("pdf", "PDF"), ("stl", "STL"), ("igs", "IGES"), ("stp", "STEP AP214")])
        file = f"{name}.{file}"
        step.document(child, file, form, self.dice.random() < 0.5)
        self.notes.append(file)
        if self.dice.random() < 0.5:
            self.part(folder / file)


def check(sdm: Path, seed: int) -> str:
    """What is wrong, or nothing."""
    with tempfile.TemporaryDirectory() as name:
        case = Case(Path(name) / "x" / "y", seed)
        run = subprocess.run([sdm, "info", case.folder / "main.step", "--json"], capture_output=True, text=True, check=False)
        if case.faults:
            if run.returncode == 0:
                return f"passes without {' or '.join(case.faults)}"
            if run.returncode == 1 and any(fault in run.stderr for fault in case.faults):
                return ""
            return f"has another error than {case.faults}: {run.returncode} {run.stderr}"
        if run.returncode != 0:
            return f"ended with {run.returncode}: {run.stderr}"
        info = json.loads(run.stdout)
        volume = (info["volume"]["lower"] + info["volume"]["upper"]) / 2
        if info["components"] != case.boxes or abs(volume - case.volume) > 1e-6 * case.volume:
            return f"has {info['components']} boxes of {volume}, not {case.boxes} of {case.volume}"
        notes = [note for note in info["notes"] if "files that are not read" in note]
        named = [note for note in notes if all(text in note for text in case.notes) or f"and {len(case.notes) - 3} more" in note]
        return "" if len(notes) == len(named) == min(len(case.notes), 1) else f"has the notes {notes}, not of {case.notes}"


if __name__ == "__main__":
    random_cases.run("assemblies", __doc__, check)
