"""One MJCF text for each rule by which MJCF files are read, and random ones of all rules together."""

from random import Random

BOX = '<geom type="box" size="0.1 0.2 0.3" pos="0.1 0.2 0"/>'
STATED = '<inertial pos="0.1 0 0.2" mass="2" diaginertia="1 1.5 2" euler="3 40 5"/>'
HINGE = '<joint axis="0 1 1" pos="0.1 0 0"/>'
TETRAHEDRON = "0 0 0 1 0 0 0 2 0 0 0 3"


def model(inside: str, top: str = "") -> str:
    """Return a file with one body in the world. top: sections besides <worldbody>."""
    return f'<mujoco>{top}<worldbody><body name="a" pos="1 2 3" euler="40 50 60">{inside}</body></worldbody></mujoco>'


def mesh(attributes: str, geom: str, compiler: str = "") -> str:
    """Return a file with a mesh and a geom that names it."""
    asset = f'<compiler {compiler}/><asset><mesh name="m" vertex="{TETRAHEDRON}" {attributes}/></asset>'
    return model(f'{HINGE}<joint axis="1 0 0"/><geom mesh="m" pos="0.3 0.2 0.1" euler="10 20 30" {geom}/>', asset)


#: A text for each rule whose numbers MuJoCo reads to rounding.
RULES = {
    "several joints": model(f'{HINGE}<joint type="slide" axis="1 0 0"/><joint axis="0 0 1" pos="0 0.2 0"/>{BOX}'),
    "free": model(f"<freejoint/>{BOX}"),
    "aligned": model(f'<freejoint align="true"/>{STATED}'),
    "aligned by the compiler": model(f'<joint type="free"/>{STATED}', '<compiler alignfree="true"/>'),
    "ball": model(f'<joint type="ball" pos="0.1 0.2 0.3" damping="0.4"/>{BOX}<body>{HINGE}{BOX}</body>'),
    "reference": model(
        f'<joint axis="0 1 1" pos="0.1 0 0" ref="30"/><joint type="slide" axis="1 2 0" ref="0.3"/>{BOX}'
        f"<body>{HINGE}{BOX}</body>"
    ),
    "springs": model(f'<joint ref="30" stiffness="3" springref="20" damping="0.5" armature="0.2"/>{BOX}'),
    "spring and damper": model(
        f'<joint springdamper="0.5 2" armature="0.1"/>{BOX}<body pos="0.3 0 0"><joint axis="0 1 0" ref="20"/>{BOX}</body>'
    ),
    "frames": model(
        f'{HINGE}<frame pos="1 0 0" euler="10 20 30">{BOX}<joint axis="1 0 2" pos="0.1 0.2 0.3"/>'
        f'<frame pos="0 1 0" zaxis="1 1 0"><body pos="0 0 1">{HINGE}{BOX}</body>{BOX}</frame></frame>'
    ),
    "stated in a frame": model(f'{HINGE}<frame pos="0 0 1" euler="0 90 0">{STATED}</frame>'),
    "fixed and massless bodies": model(
        f'{HINGE}{BOX}<body pos="0 0 1" euler="0 0 30"><body pos="1 0 0">{BOX}'
        f'<body><joint axis="1 0 0"/>{BOX}</body></body></body>'
    ),
    "moments without mass": model(
        f'{HINGE}{BOX}<body euler="10 20 30"><inertial pos="0 0 0" mass="0" diaginertia="1 2 2.5"/></body>'
    ),
    "classes": model(
        f'<joint/>{BOX}<frame childclass="y"><geom size="0.1"/></frame><geom class="x" size="0.2" pos="1 0 0"/>'
        f'<body childclass="x"><joint/><geom size="0.1"/><geom class="main" size="0.1" pos="1 0 0"/></body>',
        '<default class="main"><geom density="500"/><joint axis="1 0 0" damping="0.3"/><default class="x"><geom density="50"/>'
        '<joint axis="0 1 0"/><default class="y"><geom mass="3"/></default></default></default>',
    ),
    "an attitude instead of a default one": model(
        f'{HINGE}<geom type="box" size="0.1 0.2 0.3" euler="10 20 30"/>', '<default><geom quat="1 2 3 4"/></default>'
    ),
    "replicas": model(
        f'{HINGE}{BOX}<replicate count="3" euler="0 0 30" offset="0.5 0 0.1" sep="-"><body name="b" pos="0 0 1">'
        f'<joint name="j"/>{BOX}<replicate count="2" offset="0 1 0">{BOX}</replicate></body></replicate>'
    ),
    "radian": model(f'<joint axis="0 1 1" ref="0.5" range="-1 1"/>{BOX}', '<compiler angle="radian"/>'),
    "several compilers": model(
        f'<joint axis="0 1 1" ref="0.5" range="-1 1"/>{BOX}',
        '<compiler angle="radian" eulerseq="XYZ"/><compiler eulerseq="zyx"/>',
    ),
    "total mass": model(f"{HINGE}{BOX}<body>{BOX}</body>", '<compiler settotalmass="14"/>'),
    "total mass of fused bodies": model(
        f"{BOX}<body>{HINGE}{BOX}<body>{BOX}</body></body>", '<compiler settotalmass="14" fusestatic="true"/>'
    ),
    "fused and without visuals": model(
        f'{BOX}<body>{HINGE}{BOX}<body pos="1 0 0" euler="10 20 30">{BOX}'
        f'<geom size="0.1" contype="0" conaffinity="0"/></body></body>',
        '<compiler fusestatic="true" discardvisual="true"/>',
    ),
    "smallest mass": model(f'{HINGE}{BOX}<body pos="1 0 0" euler="1 2 3"/>', '<compiler boundmass="0.5" boundinertia="0.01"/>'),
    "smallest moment": model(f"{HINGE}{STATED}", '<compiler boundinertia="1.7"/>'),
    "balance": model(
        f'{HINGE}<inertial pos="0.1 0 0" mass="2" diaginertia="1 1 3" euler="1 2 3"/>', '<compiler balanceinertia="true"/>'
    ),
    "from geoms": model(f"{HINGE}{STATED}{BOX}", '<compiler inertiafromgeom="true"/>'),
    "groups": model(f'{HINGE}{BOX}<geom size="0.3" group="4"/>', '<compiler inertiagrouprange="0 3"/>'),
    "tiny geoms": model(f'{HINGE}<geom type="box" size="0.1 0.2 0.3"/><geom size="1e-5" mass="3"/>'),
    "ends": model(f'{HINGE}<geom type="capsule" size="0.1" fromto="0 0 0 0.3 0.2 -0.1"/>'),
    "height field": model(
        f'{HINGE}<geom type="hfield" hfield="h" pos="1 0 0"/>',
        '<asset><hfield name="h" nrow="2" ncol="2" size="1 2 3 4"/></asset>',
    ),
    **{
        f"{kind}{' shell' * shell}": model(f'{HINGE}<geom type="{kind}" size="{size}" shellinertia="{str(shell).lower()}"/>')
        for kind, size in (("box", "1 2 3"), ("sphere", "2"), ("cylinder", "1 3"), ("capsule", "1 3"), ("ellipsoid", "1 2 3"))
        for shell in (False, True)
        if (kind, shell) != ("ellipsoid", True)
    },
    "several geoms": model(f'{HINGE}{BOX}<geom size="0.2" pos="1 0 0"/>'),
    "full": model(f'{HINGE}<inertial pos="0 0 1" mass="2" fullinertia="1 1.5 2 0.1 0.2 0.3"/>'),
    "no gravity": model(f"{HINGE}{BOX}", '<option gravity="1 2 3"><flag gravity="disable"/></option>'),
    "gravity": model(f"{HINGE}{BOX}", '<option gravity="1 2 3"/><option timestep="0.01"/>'),
    "no springs": model(
        f'<joint stiffness="3" damping="2"/>{BOX}', '<option><flag spring="disable" damper="disable"/></option>'
    ),
}

#: A text for each rule of meshes.
MESHES = {
    **{f"mesh {rule}": mesh(f'inertia="{rule}"', 'type="mesh"') for rule in ("legacy", "convex", "exact", "shell")},
    "mesh not convex": mesh('inertia="legacy" face="0 2 1 0 1 3 1 2 3 0 3 2 0 1 2 2 1 3"', 'type="mesh"'),
    "mesh scaled": mesh('scale="1 -2 3"', 'type="mesh"'),
    "mesh moved": mesh('refpos="1 2 3" refquat="1 2 3 4"', 'type="mesh"'),
    **{
        f"fitted {kind}{' ' * bool(whole)}{whole}": mesh("", f'type="{kind}" fitscale="1.5"', whole and 'fitaabb="true"')
        for kind in ("box", "sphere", "capsule", "cylinder", "ellipsoid")
        for whole in ("", "bounds")
    },
}


def random_text(chance: Random) -> str:
    """Return a random tree of bodies with joints, frames, classes and geoms of all kinds."""
    compiler = " ".join(
        chance.choice(choices)
        for choices in (
            ["", 'angle="radian"'],
            ["", 'eulerseq="XYz"', 'eulerseq="zxz"'],
            ["", 'inertiafromgeom="true"'],
            ["", 'boundmass="0.4"', 'settotalmass="3"', 'boundinertia="0.01"'],
        )
    )
    default = f'<default><joint {_properties(chance)}/><default class="x"><geom density="300"/></default></default>'
    return f"<mujoco><compiler {compiler}/>{default}<worldbody>{_body(chance, 3, chance.random() < 0.3)}</worldbody></mujoco>"


def _numbers(chance: Random, count: int, size: float = 1.0) -> str:
    return " ".join(f"{chance.uniform(-size, size):.3f}" for _ in range(count))


def _pose(chance: Random) -> str:
    turn = chance.choice(
        ["", f'euler="{_numbers(chance, 3, 3)}"', f'quat="1 {_numbers(chance, 3)}"', f'zaxis="1 {_numbers(chance, 2)}"']
    )
    return f'pos="{_numbers(chance, 3)}" {turn}'


def _properties(chance: Random) -> str:
    return chance.choice(["", 'damping="0.3"', 'armature="0.1"', 'stiffness="2" springref="0.4"'])


def _body(chance: Random, depth: int, free: bool) -> str:
    joints = "<freejoint/>" if free else "".join(_joint(chance) for _ in range(chance.choice([0, 1, 1, 2, 3])))
    if not free and chance.random() < 0.2:
        joints += f'<joint type="ball" pos="{_numbers(chance, 3)}" armature="0" stiffness="0"/>'
    geoms = "".join(_geom(chance) for _ in range(chance.choice([1, 1, 2])))
    inner = "".join(_body(chance, depth - 1, free=False) for _ in range(chance.choice([0, 1, 2]))) if depth else ""
    inside = joints + geoms + inner
    if not free and chance.random() < 0.3:
        inside = f"<frame {_pose(chance)}>{inside}</frame>"
    stated = chance.choice(["", f'<inertial {_pose(chance)} mass="1.3" diaginertia="0.3 0.4 0.5"/>'])
    return f"<body {_pose(chance)} {chance.choice(['', 'childclass=' + chr(34) + 'x' + chr(34)])}>{stated}{inside}</body>"


def _joint(chance: Random) -> str:
    kind = chance.choice(["hinge", "hinge", "slide"])
    reference = chance.choice(["", f'ref="{chance.uniform(-1, 1):.3f}"'])
    limits = chance.choice(["", 'range="-0.3 0.7"'])
    axis = f"1 {_numbers(chance, 2)}"
    return f'<joint type="{kind}" axis="{axis}" pos="{_numbers(chance, 3)}" {reference} {limits} {_properties(chance)}/>'


def _geom(chance: Random) -> str:
    kind, size = chance.choice(
        [
            ("box", "0.3 0.4 0.5"),
            ("sphere", "0.4"),
            ("capsule", "0.2 0.4"),
            ("cylinder", "0.3 0.2"),
            ("ellipsoid", "0.2 0.3 0.4"),
        ]
    )
    weight = chance.choice(["", 'mass="0.7"', 'density="200"', 'shellinertia="true"' if kind != "ellipsoid" else ""])
    return f'<geom type="{kind}" size="{size}" {_pose(chance)} {weight}/>'
