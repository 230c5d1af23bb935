"""What the operator is told."""

from spirob.robot import Scene


def set_up(scene: Scene) -> str:
    """How arm and surroundings have to stand before a trial."""
    around = scene.cylinder
    put = "nothing near the arm"
    if around:
        put = (
            f"a cylinder of {1e3 * around.diameter:.1f} mm at x = {1e3 * around.x:.1f} mm, "
            f"y = {1e3 * around.y:.1f} mm"
        )
    if hung := scene.weights:
        put += f", weights of {hung.left:g} kg (left) and {hung.right:g} kg (right) on the drums"
    return f"Arm straight and at rest, tendons just taut, {put}; then press Enter. "
