"""PlatformIO runs this when it builds a project with Touchstone: it links the library of `src` that fits the board, by the options with which
the board's sketch is compiled. (Arduino finds it by itself.)"""
import os
import sys

Import("env")  # noqa: F821 (PlatformIO defines it)

FLAGS = [str(flag) for key in ("CCFLAGS", "ASFLAGS", "LINKFLAGS") for flag in env.Flatten(env.get(key, []))]  # noqa: F821


def told(option):
    """The value of a compiler's option such as -mcpu=cortex-m4; nothing if the board does not give it."""
    values = [flag.split("=", 1)[1] for flag in FLAGS if flag.startswith(option + "=")]
    return values[-1] if values else ""


cpu = (told("-mcpu") or env.BoardConfig().get("build.cpu", "")).split("+")[0]  # noqa: F821
place = cpu
if told("-mfloat-abi") == "hard":
    place = cpu + "/" + told("-mfpu") + "-hard"
folder = os.path.join(os.getcwd(), "src", *place.split("/"))
if not cpu or not os.path.isfile(os.path.join(folder, "libtouchstone_c.a")):
    sys.stderr.write(
        "Touchstone has no library for this board (it looked for src/%s): build one with Rust and put it there, "
        "see README.md\n" % place
    )
    env.Exit(1)  # noqa: F821
env.Append(LIBPATH=[folder], LIBS=["touchstone_c"])  # noqa: F821
