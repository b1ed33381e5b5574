"""What the scripts of this folder share: a URDF's joint tree, directed paths through it, and Pinocchio as the oracle.

Conventions (the same as the library's):

- a chain is the directed path from a link `base` to a link `tip`, in either direction through the tree;
- `joints` are the movable, non-mimic joints that the pose of the tip in the base depends on, in path order; a mimic
  joint whose driver is not on the path puts the driver's name at its own place;
- the Jacobian is the twist (linear; angular) of the tip relative to the base, taken at the tip's origin, in the
  base's axes, as six rows: vx vy vz wx wy wz.

Pinocchio is asked for frames' placements and Jacobians only. Which joints are on the path, and how mimic joints fold
into their drivers, is worked out here from the XML.

Needs: Python 3.10+, numpy, pin (Pinocchio) from PyPI; see the calling scripts for the versions used.
"""

import math
import os
import pathlib
import random
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

MOVABLE = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """One joint of a URDF; `mimic` is (driver, multiplier, offset) or None."""

    name: str
    kind: str
    parent: str
    child: str
    lower: float
    upper: float
    mimic: tuple | None


def _number(element, key, default):
    value = None if element is None else element.get(key)
    return default if value is None else float(value)


def read_joints(path):
    """The joints of a URDF file, in file order."""
    # Real files carry prefixes (drake:, xacro:) that they do not declare; none of these describes a joint.
    text = pathlib.Path(path).read_text(encoding="utf-8")
    text = re.sub(r"(<[/]?|\s)[\w.-]+:([\w.-]+(?=[\s/>=]))", r"\1foreign-\2", text)
    joints = []
    for element in ElementTree.fromstring(text):
        if element.tag != "joint" or element.find("child") is None:
            continue
        limit, mimic = element.find("limit"), element.find("mimic")
        # Without a stated range a joint is sampled over half a turn either way (or over one metre).
        reach = 0.5 if element.get("type") == "prismatic" else math.pi
        stated = limit is not None and (limit.get("lower") is not None or limit.get("upper") is not None)
        if element.get("type") == "continuous" or not stated:
            lower, upper = -reach, reach
        else:
            lower, upper = _number(limit, "lower", 0.0), _number(limit, "upper", 0.0)
        joints.append(
            Joint(
                name=element.get("name"),
                kind=element.get("type"),
                parent=element.find("parent").get("link"),
                child=element.find("child").get("link"),
                lower=lower,
                upper=upper,
                mimic=None
                if mimic is None
                else (mimic.get("joint"), _number(mimic, "multiplier", 1.0), _number(mimic, "offset", 0.0)),
            )
        )
    return joints


def path_between(joints, base, tip):
    """The joints from `base` up to the common ancestor, then down to `tip`; None if the links are not connected."""
    above = {joint.child: joint for joint in joints}

    def to_root(link):
        climbed = []
        while link in above:
            climbed.append(above[link])
            link = above[link].parent
        return climbed, link

    up, root_of_base = to_root(base)
    down, root_of_tip = to_root(tip)
    if root_of_base != root_of_tip:
        return None
    while up and down and up[-1].name == down[-1].name:
        up.pop()
        down.pop()
    return up + down[::-1]


class UnknownDriver(ValueError):
    """A mimic joint names a driver that the file does not hold."""


def resolve_mimic(joint, by_name):
    """(driver, multiplier, offset) with mimics of mimics folded: position = multiplier * driver + offset."""
    multiplier, offset, visited = 1.0, 0.0, set()
    while joint.mimic is not None:
        driver, factor, shift = joint.mimic
        if driver not in by_name or driver in visited:
            raise UnknownDriver(f'joint "{joint.name}" mimics "{driver}", which the file does not hold')
        visited.add(driver)
        offset += multiplier * shift
        multiplier *= factor
        joint = by_name[driver]
    return joint, multiplier, offset


def chain_joints(joints, base, tip):
    """The driving joints of the chain in path order (see the module's text)."""
    by_name = {joint.name: joint for joint in joints}
    moving = [joint for joint in path_between(joints, base, tip) if joint.kind in MOVABLE]
    own = {joint.name for joint in moving if joint.mimic is None}
    order = []
    for joint in moving:
        driver = resolve_mimic(joint, by_name)[0]
        if joint.mimic is not None and driver.name in own:
            continue
        if driver.kind in MOVABLE and driver.name not in [known.name for known in order]:
            order.append(driver)
    return order


def sampler(*words):
    """A random generator that depends on the words alone (the same on every machine and version)."""
    return random.Random("/".join(words))


def sample(generator, drivers):
    """One configuration, uniform within the limits."""
    return [generator.uniform(joint.lower, joint.upper) for joint in drivers]


class PinocchioRobot:
    """A URDF file as Pinocchio reads it; mimic joints are folded here, not by Pinocchio."""

    def __init__(self, path):
        import pinocchio

        self.pin = pinocchio
        self.joints = read_joints(path)
        self.by_name = {joint.name: joint for joint in self.joints}
        self.driven = {joint.name: self._drive(joint) for joint in self.joints}
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.data = self.model.createData()

    def _drive(self, joint):
        """How a joint follows its driver; one whose driver is missing rests at zero by itself."""
        try:
            return resolve_mimic(joint, self.by_name)
        except UnknownDriver:
            return joint, 1.0, 0.0

    def has(self, link):
        """Whether Pinocchio knows the link."""
        return self.model.existFrame(link, self.pin.FrameType.BODY)

    def _frame(self, link):
        if not self.has(link):
            raise KeyError(link)
        return self.model.getFrameId(link, self.pin.FrameType.BODY)

    def _configuration(self, positions):
        q = self.pin.neutral(self.model)
        for index in range(1, self.model.njoints):
            name, joint = self.model.names[index], self.model.joints[index]
            if name not in self.by_name:
                continue
            driver, multiplier, offset = self.driven[name]
            value = multiplier * positions.get(driver.name, 0.0) + offset
            if joint.nq == 1:
                q[joint.idx_q] = value
            elif joint.nq == 2:
                q[joint.idx_q : joint.idx_q + 2] = math.cos(value), math.sin(value)
        return q

    def pose_and_jacobian(self, base, tip, drivers, q):
        """(position, rotation, jacobian) of `tip` relative to `base`, in base axes, at joint values `q`."""
        import numpy

        pin, model, data = self.pin, self.model, self.data
        positions = {joint.name: value for joint, value in zip(drivers, q, strict=True)}
        configuration = self._configuration(positions)
        pin.computeJointJacobians(model, data, configuration)
        pin.updateFramePlacements(model, data)
        base_frame, tip_frame = self._frame(base), self._frame(tip)
        world_from_base, world_from_tip = data.oMf[base_frame], data.oMf[tip_frame]
        base_from_tip = world_from_base.actInv(world_from_tip)

        aligned = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        of_tip = pin.getFrameJacobian(model, data, tip_frame, aligned)
        of_base = pin.getFrameJacobian(model, data, base_frame, aligned)
        # The base's twist, taken at the tip's origin: v + omega x (p_tip - p_base).
        arm = world_from_tip.translation - world_from_base.translation
        relative = of_tip - of_base
        relative[:3] += pin.skew(arm) @ of_base[3:]
        relative = numpy.vstack([world_from_base.rotation.T @ relative[:3], world_from_base.rotation.T @ relative[3:]])

        jacobian = numpy.zeros((6, len(drivers)))
        columns = {joint.name: column for column, joint in enumerate(drivers)}
        for index in range(1, model.njoints):
            if model.names[index] not in self.by_name or model.joints[index].nv != 1:
                continue
            driver, multiplier, _ = self.driven[model.names[index]]
            if driver.name in columns:
                jacobian[:, columns[driver.name]] += multiplier * relative[:, model.joints[index].idx_v]
        return base_from_tip.translation.copy(), base_from_tip.rotation.copy(), jacobian


def number(value):
    """A float in 17 significant digits, which identify a double."""
    value = float(value)
    return "0" if value == 0.0 else format(value, ".17g")


def array(values):
    """A JSON array, nested as the argument is."""
    return "[" + ", ".join(array(v) if hasattr(v, "__len__") else number(v) for v in values) + "]"


def write_chains(path, head, chains):
    """Writes {**head, "chains": [...]} with one sample on a line; `chains` hold strings, name lists and samples."""
    import json

    lines = ["{"]
    lines += [f"  {json.dumps(key)}: {json.dumps(value)}," for key, value in head.items()]
    lines.append('  "chains": [')
    for index, chain in enumerate(chains):
        lines.append("    {")
        lines += [f"      {json.dumps(k)}: {json.dumps(v)}," for k, v in chain.items() if k != "samples"]
        lines.append('      "samples": [')
        rows = ["        {" + ", ".join(f'"{k}": {array(v)}' for k, v in row.items()) + "}" for row in chain["samples"]]
        lines.append(",\n".join(rows))
        lines.append("      ]")
        lines.append("    }" + ("," if index + 1 < len(chains) else ""))
    lines += ["  ]", "}", ""]
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines))
    samples = sum(len(chain["samples"]) for chain in chains)
    print(f"{path}: {len(chains)} chains, {samples} samples, {os.path.getsize(path)} bytes")
