"""Whether an interface of python-can can be used here, before it is opened."""

from importlib.util import find_spec

import can

from spirob.errors import HardwareError

# interface -> the module that it needs beside python-can, which extra `can` brings
NEEDS = {
    "udp_multicast": "msgpack",
    "robotell": "serial",
    "seeedstudio": "serial",
    "serial": "serial",
    "slcan": "serial",
}
PACKAGES = {"serial": "pyserial"}


def require_known(interface: str, what: str) -> None:
    """Raises HardwareError, about `what`, where python-can has no such interface."""
    if interface not in can.VALID_INTERFACES:
        known = ", ".join(sorted(can.VALID_INTERFACES))
        raise HardwareError(f"{what}: no interface '{interface}'; known: {known}")


def require_interface(interface: str, what: str) -> None:
    """Raises HardwareError, about `what`, where there is no such interface or its library lacks."""
    require_known(interface, what)
    module = NEEDS.get(interface)
    if module and find_spec(module) is None:
        package = PACKAGES.get(module, module)
        raise HardwareError(
            f"{what}: {interface} needs {package}, which is not installed: "
            f'pip install -e ".[can]", or pip install {package}'
        )
