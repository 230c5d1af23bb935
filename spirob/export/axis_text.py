"""The functions of a plain axis as text of plain arithmetic; `axis` puts the kernels in.

Names in capitals are constants, `s` is the state.  The equations are those of
`spirob.machine.inverse.equations` (compensate) and `spirob.machine.forward` (torque).
"""

MOVED = """\
    q = position
    v = speed
    a = acceleration
    effort = 0.0
{behind}
    load = loaded(s, q, a)
{hinge}
    slow = a
{ahead}
"""
COMPENSATE = (
    '''
def compensate(s, position, speed, acceleration, dt):
    """Effort to command so that the axis moves so; call it once for each step of a motion."""
'''
    + MOVED
    + """\
    needed = load + VISCOUS * v + s.offset + OWN_INERTIA * a
    needed = needed + {share} * LOAD_INERTIA * (a - slow)
{added}
    wanted = needed / SCALE
    effort = wanted
{solved}
    effort = effort + BACK_EMF * v
{current}
    s.time = s.time + dt
    return effort
"""
)
LOADED = '''
def loaded(s, q, a):
    """What the transmission passes on, without effects."""
    return LOAD_INERTIA * a + STIFFNESS * q + s.carried
'''
WITH_PAYLOAD = '''
def loaded(s, q, a):
    """What the transmission passes on, without effects."""
    weight = PAYLOAD_COSINE * math.cos({turned}) + PAYLOAD_SINE * math.sin({turned})
    own = LOAD_INERTIA * a + STIFFNESS * q
    return own + s.payload * (PAYLOAD_INERTIA * a + weight) + s.carried
'''
MOTOR = (
    '''
def motor(s, position, speed, acceleration, dt):
    """The motor's motion where this is what the sensor tells; a state of its own for it."""
'''
    + MOVED
    + """\
    s.time = s.time + dt
    return q, v, slow + {share} * (a - slow)
"""
)
TORQUE = '''
def torque(s, position, speed, acceleration, effort, dt):
    """What drive and effects put on the axis, friction negative, at this effort."""
    q = position
    v = speed
    a = acceleration
    load = loaded(s, q, a)
    held = 0.0
{held}
    load = load - held
{sensor}
    effort = effort - BACK_EMF * v
    passed = effort
{pipes}
    share = 1.0
{shares}
    out = SCALE * share * passed + held
{added}
    s.time = s.time + dt
    return out
'''
REPORTED = '''
def reported(s, effort, dt):
    """The effort as the drive reports it; call it once for each step of a log."""
{report}
    return effort
'''
FRAMED = '''
def framed(s, effort, dt):
    """The effort in a frame as late as the bus brings it; call it once for each cycle."""
{frame}
    return effort
'''
MISREAD = '''
def misread(q, v):
    """Error of the position sensor where it reads this position."""
    read = q
    error = 0.0
    for _ in range({readings}):
        q = read - error
        error = 0.0
{errors}
    return error
'''
SEEN = '''
def seen(s, position, load):
    """The position as its sensor reads it, under this load."""
    q = position
    v = 0.0
    effort = 0.0
    error = 0.0
{errors}
    return q + error
'''
BEHIND = '''
def behind(q, v, a, dt):
    """Position, speed and acceleration without the errors of the position sensor."""
    here = misread(q, v)
    later = misread(q + v * dt + 0.5 * a * dt * dt, v)
    sooner = misread(q - v * dt + 0.5 * a * dt * dt, v)
    first = (later - sooner) / (2.0 * dt)
    second = (later - 2.0 * here + sooner) / (dt * dt)
    return q - here, v - first, a - second
'''
AHEAD = """\
    error = 0.0
{errors}
    first = 0.0
    second = 0.0
    if s.rows >= 1.0:
        first = (error - s.error_1) / dt
    if s.rows >= 2.0:
        first = (3.0 * error - 4.0 * s.error_1 + s.error_2) / (2.0 * dt)
        second = (error - 2.0 * s.error_1 + s.error_2) / (dt * dt)
    if s.rows >= 3.0:
        second = (2.0 * error - 5.0 * s.error_1 + 4.0 * s.error_2 - s.error_3) / (dt * dt)
    s.error_3 = s.error_2
    s.error_2 = s.error_1
    s.error_1 = error
    s.rows = min(s.rows + 1.0, 3.0)
    q = q - error
    v = v - first
    a = a - second"""
SOLVED = """\
    step = 1.0
    missed = 1e300
    moved = 0.0
    edge = 0.0
    for turn in range({passes}):
        passed = effort
{pipes}
        share = 1.0
{shares}
        miss = wanted - share * passed
        if abs(miss) <= 1e-12 * abs(wanted):
            break
        flat = miss * missed > 0.0 and abs(miss) > 0.5 * abs(missed)
        slope = 1.0
        if missed - miss != 0.0:
            slope = moved / (missed - miss)
        if flat:
            edge = 1.0
            step = 2.0 * step
        else:
            step = 1.0
            if edge == 0.0 and slope > 0.5 and slope < 2.0:
                step = slope
        moved = step * miss
        missed = miss
        effort = effort + moved
{kept}"""
