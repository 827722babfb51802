r"""The screenshots of docs/guide/blender.md, drawn by Blender itself; needs a display, a virtual one too:

xvfb-run -s '-screen 0 1600x900x24' blender --enable-event-simulate --factory-startup -P blender.py -- \
    ADDON.zip CHARACTER.pleat SERVER FOLDER
"""

import pathlib
import sys

import bpy

ADDON, MODEL, SERVER, FOLDER = sys.argv[sys.argv.index("--") + 1:]
TAB = (1308, 582)  # of Pleat in the sidebar of a window of 1600 x 900, which only a click chooses
steps = []
bpy.context.preferences.view.show_splash = False


def step(function):
    steps.append(function)
    return function


def view():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region}


@step
def install():
    bpy.ops.preferences.addon_install(filepath=ADDON)
    bpy.ops.preferences.addon_enable(module="pleat_blender")
    bpy.context.preferences.addons["pleat_blender"].preferences.address = SERVER
    for found in list(bpy.data.objects):
        bpy.data.objects.remove(found)


@step
def bring_in():
    with bpy.context.temp_override(**view()):
        bpy.ops.pleat.connect()
        bpy.ops.pleat.open(filepath=MODEL)


@step
def pose():
    from mathutils import Quaternion
    rig = bpy.context.object
    for name, axis, degrees in (("leftUpperLeg", (1, 0, 0), -35), ("rightLowerArm", (1, 0, 0), 50),
                                ("leftUpperArm", (0, 0, 1), 30), ("leftLowerArm", (1, 0, 0), 40)):
        if name in rig.pose.bones:
            rig.pose.bones[name].rotation_quaternion = Quaternion(axis, degrees * .01745)
    with bpy.context.temp_override(**view()):
        bpy.ops.object.mode_set(mode="POSE")


@step
def arrange():
    area = view()["area"]
    space = area.spaces.active
    space.show_region_ui = True
    space.overlay.show_floor = False
    with bpy.context.temp_override(**view()):
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_orbit(angle=.6, type="ORBITRIGHT")
        bpy.ops.view3d.view_orbit(angle=.2, type="ORBITUP")
        space.region_3d.view_location = (.25, 0, .85)
        space.region_3d.view_distance = 2.7


@step
def choose_tab():
    window = view()["window"]
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=TAB[0], y=TAB[1])
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=TAB[0], y=TAB[1])
    window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=TAB[0], y=TAB[1])


def shoot(name):
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=2)
    with bpy.context.temp_override(**view()):
        bpy.ops.screen.screenshot(filepath=str(pathlib.Path(FOLDER) / name))


@step
def folds():
    shoot("blender.png")


@step
def colors():
    bpy.context.object.pleat.show_heat = True
    shading = view()["area"].spaces.active.shading
    shading.color_type = "VERTEX"


@step
def wait():
    from pleat_blender import live
    shown = live.find(bpy.context.object)
    return shown.shown_number < shown.number  # a mesh that is late: again


@step
def heat():
    shoot("blender_confidence.png")


@step
def leave():
    bpy.ops.wm.quit_blender()


def run():
    if not steps[0]():
        steps.pop(0)
    return .7 if steps else None


bpy.app.timers.register(run, first_interval=2)
