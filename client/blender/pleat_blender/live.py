"""The detailed mesh while the artist poses or plays.

A change of the armature is read on the interface's thread, a worker makes the mesh, and the interface takes it when it
is there: at once when it comes within WAIT_SECONDS, so that playing shows the frame that it plays, and with a timer
otherwise. Where there is no mesh (no server, no library, an error) Blender's own skinning shows the character.
"""

import uuid

import bpy
from bpy.app.handlers import persistent

from . import armature, heat, models
from .library import PleatError
from .recording import frame_rate
from .timeline import Timeline
from .worker import InProcess, OnServer, Request, Worker

WAIT_SECONDS = .015
AWAY_SECONDS = 1.0  # an answer that takes longer shows skinning meanwhile
BACKGROUND_SECONDS = 20.0  # without an interface nothing else is to be done
POLL_SECONDS, IDLE_SECONDS = 1 / 60, .25

_shown = {}  # Live by the key of its armature
_suspended = False  # while a file is written


class Live:
    """One armature that shows its detailed mesh."""

    def __init__(self, rig, preferences):
        settings = rig.pleat
        self.key, self.name, self.character = settings.key, rig.name, models.load(settings)
        missing = armature.missing_bones(rig, self.character)
        if missing:
            raise PleatError("FAILED_PRECONDITION", f"'{rig.name}' has no bones {', '.join(missing)}: the character's "
                                                    "joints must keep their names")
        self.timeline = Timeline(self.character.history, self.character.frames_per_second)
        self.number, self.status = 0, ""
        self.confidence, self.seconds, self.shown_number = 0.0, 0.0, 0
        character, address, token = self.character, settings.address, preferences.token
        model_id, content = settings.model_id, 0 if settings.content == "MESH" else 1
        bits = settings.position_bits
        if settings.source == "SERVER":
            def source():
                return OnServer(character, address, model_id, token, content, bits)
        else:
            def source():
                return InProcess(character)
        self.worker = Worker(source, heat.vertex_weights(character.influences(), character.num_joints))

    def ask(self, rig, scene, depsgraph):
        """Asks for the mesh of the armature as it is now."""
        frame = scene.frame_current_final
        self.timeline.put(frame, *armature.read_pose(rig.evaluated_get(depsgraph), self.character))
        roots, rotations = self.timeline.query(frame, float(frame_rate(scene)))
        self.number += 1
        self.worker.submit(Request(self.number, roots, rotations, rig.pleat.strength, rig.pleat.show_heat))

    def show(self, rig, timeout):
        """Shows what has come. Returns True when the newest mesh is shown."""
        mesh = rig.pleat.mesh
        result = self.worker.take(self.number, timeout)
        if mesh is None:
            return True
        if result is None:
            if self.worker.waiting_seconds() > AWAY_SECONDS:
                self.status = "no answer yet, skinning meanwhile"
                armature.show_skinning(mesh)
            return False
        if result.error is not None:
            self.status = f"skinning only: {result.error}"
            armature.show_skinning(mesh)
            return result.number == self.number
        if len(mesh.data.vertices) != len(result.positions):
            self.status = f"'{mesh.name}' no longer has the character's {len(result.positions)} vertices"
            return True
        armature.show_positions(mesh, result.positions)
        if result.colors is not None:
            armature.show_colors(mesh, result.colors)
        self.status, self.confidence, self.seconds = "", result.confidence, result.seconds
        self.shown_number = result.number
        return result.number == self.number

    def stop(self):
        self.worker.stop()


def find(rig):
    """The Live of an armature, or None."""
    return _shown.get(rig.pleat.key) if rig is not None else None


def _armature_of(key):
    """The armature of a Live: pointers do not survive an undo, and names may change."""
    live = _shown[key]
    named = bpy.data.objects.get(live.name)
    if named is not None and named.type == "ARMATURE" and named.pleat.key == key:
        return named
    for rig in bpy.data.objects:
        if rig.type == "ARMATURE" and rig.pleat.key == key:
            live.name = rig.name
            return rig
    return None


def _be_of_its_own(rig):
    """A copy of a character has the key and the mesh of the original: it gets a key, and the mesh below it."""
    settings = rig.pleat
    if any(other != rig and other.type == "ARMATURE" and other.pleat.key == settings.key
           for other in bpy.data.objects):
        settings.key = uuid.uuid4().hex
    if settings.mesh is None or settings.mesh.parent != rig:
        below = [child for child in rig.children if child.type == "MESH" and armature.REST in child.data.attributes]
        if not below:
            raise PleatError("FAILED_PRECONDITION", f"'{rig.name}' has lost its mesh: bring the character in again")
        settings.mesh = below[0]
        if below[0].data.users > 1:  # a linked copy would show both poses
            below[0].data = below[0].data.copy()


def start(rig, preferences):
    """Raises PleatError when the model is not there or does not fit."""
    _be_of_its_own(rig)
    stop(rig)
    _shown[rig.pleat.key] = Live(rig, preferences)
    refresh(rig)
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll, persistent=True)


def stop(rig):
    """Back to skinning."""
    live = _shown.pop(rig.pleat.key, None)
    if live is not None:
        live.stop()
    if rig.pleat.mesh is not None:
        armature.show_skinning(rig.pleat.mesh)


def stop_all():
    for key in list(_shown):
        rig = _armature_of(key)
        if rig is not None:
            stop(rig)
        else:
            _shown.pop(key).stop()
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)


def refresh(rig, clear=False):
    """Asks again after a setting has changed."""
    live = find(rig)
    if live is None:
        return
    if clear:
        live.timeline.clear()
    context = bpy.context
    live.ask(rig, context.scene, context.evaluated_depsgraph_get())
    live.show(rig, _timeout())


def _timeout():
    return BACKGROUND_SECONDS if bpy.app.background else WAIT_SECONDS


def _update(scene, depsgraph, touched=None):
    """Asks for all armatures, or for those in `touched`, and shows what comes in time."""
    if _suspended:
        return
    asked = []
    for key, live in list(_shown.items()):
        rig = _armature_of(key)
        if rig is not None and (touched is None or rig.name in touched):
            live.ask(rig, scene, depsgraph)
            asked.append((rig, live))
    for rig, live in asked:
        live.show(rig, _timeout())


@persistent
def on_frame(scene, depsgraph):
    if _shown:
        _update(scene, depsgraph)


@persistent
def on_update(scene, depsgraph):
    if not _shown or not depsgraph.id_type_updated("OBJECT") and not depsgraph.id_type_updated("ARMATURE"):
        return
    touched = {update.id.name for update in depsgraph.updates
               if isinstance(update.id, bpy.types.Object) and update.id.type == "ARMATURE"
               and (update.is_updated_geometry or update.is_updated_transform)}
    if touched:
        _update(scene, depsgraph, touched)


def _poll():
    """Shows what came later than WAIT_SECONDS."""
    waiting = False
    for key, live in list(_shown.items()):
        rig = _armature_of(key)
        if rig is None:
            _shown.pop(key).stop()  # it was deleted
            continue
        if _suspended or live.shown_number == live.number:
            continue
        before = live.status
        if not live.show(rig, 0):
            waiting = True
        if live.status != before or live.shown_number == live.number:
            _redraw()
    return POLL_SECONDS if waiting else IDLE_SECONDS if not _shown else POLL_SECONDS * 2


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


@persistent
def before_save(*_):
    """Files hold the rest pose, which Blender shows by itself, wherever they are opened."""
    global _suspended
    _suspended = True
    for key in _shown:
        rig = _armature_of(key)
        if rig is not None and rig.pleat.mesh is not None:
            armature.show_skinning(rig.pleat.mesh)


@persistent
def after_save(*_):
    global _suspended
    _suspended = False
    for key in list(_shown):
        rig = _armature_of(key)
        if rig is not None:
            refresh(rig)


@persistent
def before_load(*_):
    for live in _shown.values():
        live.stop()
    _shown.clear()


@persistent
def after_load(*_):
    """Goes on with the characters that were live when the file was written, where their models are at hand."""
    for rig in bpy.data.objects:
        if rig.type == "ARMATURE" and rig.pleat.key and rig.pleat.live:
            rig.pleat.live = True  # its update starts it, or says why not


HANDLERS = {"frame_change_post": on_frame, "depsgraph_update_post": on_update, "save_pre": before_save,
            "save_post": after_save, "load_pre": before_load, "load_post": after_load}


def register():
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    stop_all()
    for name, handler in HANDLERS.items():
        if handler in getattr(bpy.app.handlers, name):
            getattr(bpy.app.handlers, name).remove(handler)
