
import math
import os

BEADS, MANTLE, PLATES = 0, 1, 2


def material(kind, density):
    """A material, of walls a stand-in."""
    young, poisson = MATERIALS[kind]
    # The angle of friction comes from the matches below.
    return FrictMat(young=young, poisson=poisson, density=density, frictionAngle=0.0)


def per_pair(values):
    """Beads with beads, mantle and end plates; no other pairs meet."""
    return MatchMaker(matches=tuple((BEADS, kind, v) for kind, v in enumerate(values)))


def read_beads(path):
    """Positions, radii and densities of an `Atoms` section: id type diameter density x y z."""
    with open(path) as file:
        rows = file.read().split("Atoms", 1)[1].split("\n")
    return [[float(cell) for cell in row.split()] for row in rows if row.strip()]


def build():
    """Beads, mantle and end plates; returns numbers of the beads, the mantle and the plates."""
    for kind in (BEADS, MANTLE, PLATES):
        O.materials.append(material(kind, 1000.0))
    beads = []
    for _, _, diameter, density, x, y, z in read_beads("start.data"):
        radius = 0.5 * diameter
        bead = sphere((x, y, z), radius, material=O.materials[BEADS])
        mass = density * 4.0 / 3.0 * math.pi * radius**3
        bead.state.mass = mass
        bead.state.inertia = Vector3(1, 1, 1) * 0.4 * mass * radius**2
        beads.append(O.bodies.append(bead))
    # One triangle a face of the prism, wider and longer than the face: a plane that goes on
    # outside of the prism meets no bead, and no bead rolls over an edge.
    apothem = RADIUS - SAGITTA / 3.0
    width = 2.0 * RADIUS * math.tan(math.pi / FACES)
    mantle = []
    for k in range(FACES):
        angle = 2.0 * math.pi * k / FACES
        c, s = math.cos(angle), math.sin(angle)
        corners = [
            (apothem * c - along * s, apothem * s + along * c, z)
            for along, z in ((-1.1 * width, -REACH), (1.1 * width, -REACH), (0.0, 3.0 * REACH))
        ]
        face = facet([Vector3(*p) for p in corners], fixed=True, material=O.materials[MANTLE])
        mantle.append(O.bodies.append(face))
    plates = []
    if ENDS != "periodic":
        for z, inward in ((-0.5 * LENGTH, 1), (0.5 * LENGTH, -1)):
            plate = wall((0, 0, z), 2, sense=inward, material=O.materials[PLATES])
            plates.append(O.bodies.append(plate))
    return beads, mantle, plates


def limit_walls():
    """Limits of the rolling moments at the walls, which have no coefficient of their own."""
    for ids, kind in ((mantle, MANTLE), (plates, PLATES)):
        for number in ids:
            for contact in O.bodies[number].intrs():
                if contact.isReal:
                    # A limit of zero would mean none.
                    limit = max(ROLLING[kind], 1e-12)
                    contact.phys.maxBendPl = limit * contact.geom.refR2


def check_moduli():
    """Stop where this version of YADE makes other forces of the materials than the deck expects."""
    for contact in O.interactions:
        if not contact.isReal:
            continue
        kinds = [O.bodies[n].material.id for n in (contact.id1, contact.id2)]
        kind = max(kinds)
        radii = [b.shape.radius for b in (O.bodies[contact.id1], O.bodies[contact.id2])
                 if isinstance(b.shape, Sphere)]
        effective = 1.0 / sum(1.0 / r for r in radii)
        e_star, g_star = PAIR_MODULI[kind]
        for name, found, expected in (
            ("normal", contact.phys.kno, 4.0 / 3.0 * e_star * math.sqrt(effective)),
            ("tangential", contact.phys.kso, 8.0 * g_star * math.sqrt(effective)),
            ("friction", contact.phys.tangensOfFrictionAngle, FRICTION[kind]),
        ):
            if abs(found - expected) > 1e-6 * expected:
                raise RuntimeError(
                    f"{name} of pair {kind} is {found}, expected {expected}: "
                    "this deck is for YADE 2023.02"
                )


def write_frame(path):
    """Append positions as a text dump."""
    half = 0.5 * LENGTH
    lines = ["ITEM: TIMESTEP", str(O.iter), "ITEM: NUMBER OF ATOMS", str(len(beads))]
    lines.append("ITEM: BOX BOUNDS ff ff " + ("pp" if ENDS == "periodic" else "ff"))
    lines += [f"{-reach:.9g} {reach:.9g}" for reach in (RADIUS, RADIUS, half)]
    lines.append("ITEM: ATOMS id type x y z radius")
    for number, body in enumerate(beads, 1):
        x, y, z = O.bodies[body].state.pos
        if ENDS == "periodic":
            z -= LENGTH * math.floor(z / LENGTH + 0.5)
        radius = O.bodies[body].shape.radius
        lines.append(f"{number} 1 {x:.9g} {y:.9g} {z:.9g} {radius:.9g}")
    with open(path, "a") as file:
        file.write("\n".join(lines) + "\n")


if ENDS == "periodic":
    # Periodic in all directions; across, the cell is much larger than the drum.
    O.periodic = True
    O.cell.setBox(20.0 * RADIUS, 20.0 * RADIUS, LENGTH)
beads, mantle, plates = build()
O.dt = TIME_STEP
drag = LinearDragEngine(ids=beads, nu=DRAG / (6.0 * math.pi * MEAN_RADIUS))
turning = RotationEngine(
    ids=mantle,
    rotateAroundZero=True,
    zeroPoint=(0, 0, 0),
    rotationAxis=(0, 0, 1),
    angularVelocity=0.0,
)
newton = NewtonIntegrator(damping=0.0, gravity=SETTLING_GRAVITY)
rolls = any(ROLLING)
physics = Ip2_FrictMat_FrictMat_MindlinPhys(
    en=per_pair(RESTITUTION), frictAngle=per_pair([math.atan(mu) for mu in FRICTION])
)
if rolls:
    physics.krot = ROLLING_SPRING
    physics.eta = max(0.5 * ROLLING[BEADS], 1e-12)
O.engines = [
    ForceResetter(),
    InsertionSortCollider(
        [Bo1_Sphere_Aabb(), Bo1_Facet_Aabb(), Bo1_Wall_Aabb()],
        allowBiggerThanPeriod=ENDS == "periodic",
    ),
    InteractionLoop(
        # Without `noRatch` a wall that turns in its plane drags the beads along.
        [
            Ig2_Sphere_Sphere_ScGeom(),
            Ig2_Facet_Sphere_ScGeom(),
            Ig2_Wall_Sphere_ScGeom(noRatch=False),
        ],
        [physics],
        [Law2_ScGeom_MindlinPhys_Mindlin(includeMoment=rolls)],
    ),
    drag,
    turning,
    newton,
]
if rolls:
    O.engines = O.engines + [PyRunner(command="limit_walls()", iterPeriod=10)]

# The bed settles in the standing drum, gravity tilted with it.
O.run(SETTLING_STEPS, True)
check_moduli()
newton.gravity = GRAVITY
for rpm, omega, path, marks in STAGES:
    print(f"{rpm} rpm", flush=True)
    if os.path.exists(path):
        os.remove(path)
    turning.angularVelocity = omega
    if ENDS == "turning":
        for plate in plates:
            O.bodies[plate].state.angVel = (0, 0, omega)
    for steps, mark in marks:
        if steps > 0:
            O.run(steps, True)
        if mark == "frame":
            write_frame(path)
        elif mark == "half drag":
            drag.nu *= 0.5
        else:
            drag.dead = True
