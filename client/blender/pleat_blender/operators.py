"""What the buttons do. What takes long runs on a thread or in steps, and Escape ends it."""

import pathlib
import threading
import time

import bpy
from bpy.props import EnumProperty, StringProperty

from . import armature, bake, live, models, training
from .library import PleatError
from .properties import make_settings, preferences
from .recording import Recording, frame_rate
from .service import Server

STEP_SECONDS = .03  # the interface waits no longer for a step of ours
_training = None  # the TrainingRun that is under way


def _panel(context):
    return context.window_manager.pleat


def _refuse_without_network(address):
    """Blender 4.2 and later have a switch for the internet, which is not asked about this machine."""
    host = address.rpartition(":")[0].strip("[]")
    if getattr(bpy.app, "online_access", True) or host in ("127.0.0.1", "localhost", "::1", "unix"):
        return
    raise PleatError("PERMISSION_DENIED", "Blender's preferences forbid online access (System, Network)")


def rig_of(context):
    """The character of the active object, which is its armature or its mesh."""
    found = context.object
    if found is not None and found.type == "MESH" and found.parent is not None:
        found = found.parent
    return found if found is not None and found.type == "ARMATURE" and found.pleat.key else None


def import_character(context, data, path="", address=""):
    """Makes armature and mesh of a model file and shows its folds."""
    character, _ = models.read(data)
    model_id, _ = models.keep(data)
    rig, mesh = armature.build(context, character)
    settings = make_settings(rig, mesh, model_id, path, address)
    settings.live = True
    return rig


class Reporting:
    """Errors become a line of Blender's, never a traceback."""

    def execute(self, context):
        try:
            return self.run(context) or {"FINISHED"}
        except PleatError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class Stepping(Reporting):
    """An operator that works in steps. In the background it works to the end at once."""

    def run(self, context):
        self._steps = self.steps(context)
        if bpy.app.background:
            for _ in self._steps:
                time.sleep(0)
            return {"FINISHED"}
        self._timer = context.window_manager.event_timer_add(.02, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._steps.close()
            return self._end(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        until = time.monotonic() + STEP_SECONDS
        try:
            while time.monotonic() < until:
                if next(self._steps, "end") == "end":
                    return self._end(context, {"FINISHED"})
        except PleatError as error:
            self.report({"ERROR"}, str(error))
            return self._end(context, {"CANCELLED"})
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                area.tag_redraw()
        return {"RUNNING_MODAL"}

    def _end(self, context, result):
        context.window_manager.event_timer_remove(self._timer)
        return result


def _on_thread(work):
    """Steps that wait for work() on a thread and return what it returns, or raise what it raises."""
    outcome = []

    def run():
        try:
            outcome.append((work(), None))
        except Exception as error:  # noqa: BLE001: raised below
            outcome.append((None, error))
    thread = threading.Thread(target=run, name="pleat call", daemon=True)
    thread.start()
    while not outcome:
        thread.join(.005)
        yield
    result, error = outcome[0]
    if error is not None:
        raise error
    return result


class PLEAT_OT_connect(Stepping, bpy.types.Operator):
    """Ask the server for its characters"""
    bl_idname = "pleat.connect"
    bl_label = "Connect"

    def steps(self, context):
        address, token, panel = preferences(context).address, preferences(context).token, _panel(context)
        _refuse_without_network(address)
        panel.status = f"connecting to {address}"
        try:
            found = yield from _on_thread(lambda: Server(address, token, connect_seconds=2).models())
        except PleatError as error:
            panel.status = str(error)
            raise
        panel.models.clear()
        for model in reversed(found):  # the newest first
            item = panel.models.add()
            item.model_id, item.learner = model["id"], model["learner"]
            item.label = f"{model['name'] or 'character'}, {model['num_vertices']} vertices, {model['learner']}"
        panel.model_index = 0
        panel.status = f"{len(found)} character{'' if len(found) == 1 else 's'} on {address}"


class PLEAT_OT_download(Stepping, bpy.types.Operator):
    """Bring the chosen character in: an armature and its mesh"""
    bl_idname = "pleat.download"
    bl_label = "Bring in"
    bl_options = {"REGISTER", "UNDO"}
    model_id: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def steps(self, context):
        address, token, panel = preferences(context).address, preferences(context).token, _panel(context)
        model_id = self.model_id
        if not model_id:
            if not panel.models:
                raise PleatError("FAILED_PRECONDITION", "connect first, then choose a character")
            model_id = panel.models[panel.model_index].model_id
        _refuse_without_network(address)
        data = yield from _on_thread(lambda: Server(address, token, connect_seconds=2).download(model_id))
        import_character(context, data, address=address)


class PLEAT_OT_open(Reporting, bpy.types.Operator):
    """Bring a character in from a model file (.pleat), without a server"""
    bl_idname = "pleat.open"
    bl_label = "Open model file"
    bl_options = {"REGISTER", "UNDO"}
    filepath: StringProperty(subtype="FILE_PATH")
    filter_glob: StringProperty(default="*.pleat", options={"HIDDEN"})

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, context):
        try:
            data = pathlib.Path(self.filepath).read_bytes()
        except OSError as error:
            raise PleatError("NOT_FOUND", f"{self.filepath}: {error.strerror}") from error
        import_character(context, data, path=self.filepath)


def _follow(context, run):
    """The steps of a training that has been started."""
    global _training
    panel, _training = _panel(context), run
    run.start()
    try:
        while not run.done:
            panel.status, panel.fraction = run.stage, run.fraction
            run.join(.005)
            yield
        if run.error is not None:
            raise run.error
        panel.status, panel.fraction = "trained", 1
        import_character(context, run.data, address=preferences(context).address)
    except PleatError as error:
        panel.status, panel.fraction = f"{error.code.lower()}: {error}", 0
        raise
    finally:
        run.cancel()  # of a run that is over it changes nothing
        _training = None


class PLEAT_OT_train(Stepping, bpy.types.Operator):
    """Upload what the active mesh does in the scene's range, and train a character of it"""
    bl_idname = "pleat.train"
    bl_label = "Train from this mesh"

    def steps(self, context):
        chosen, panel, scene, mesh = preferences(context), _panel(context), context.scene, context.object
        _refuse_without_network(chosen.address)
        recording = Recording(context, mesh, scene.frame_start, scene.frame_end)
        panel.status = "copying frames"
        try:
            while recording.step():
                panel.fraction = recording.fraction
                yield
        finally:
            arrays = recording.finish()
        take = training.array_take(*arrays, frame_rate(scene), mesh.name)
        run = training.TrainingRun(chosen.address, chosen.token, take, mesh.name, {"learner": panel.learner})
        yield from _follow(context, run)


class PLEAT_OT_train_file(Stepping, bpy.types.Operator):
    """Upload a take from files (PC2, MDD, Alembic, OBJ, PLY, NPZ, glTF; meters, Y up), and train a character of it"""
    bl_idname = "pleat.train_file"
    bl_label = "Train from files"
    filepath: StringProperty(subtype="FILE_PATH")

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def steps(self, context):
        chosen, panel = preferences(context), _panel(context)
        _refuse_without_network(chosen.address)
        run = training.TrainingRun(chosen.address, chosen.token, training.file_take(self.filepath), "",
                                   {"learner": panel.learner})
        yield from _follow(context, run)


class PLEAT_OT_cancel(bpy.types.Operator):
    """End the training, on the server too"""
    bl_idname = "pleat.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context):
        return _training is not None

    def execute(self, context):
        _training.cancel()
        return {"FINISHED"}


class PLEAT_OT_bake(Stepping, bpy.types.Operator):
    """Keep the detailed mesh of the scene's range, so that it is shown without Pleat"""
    bl_idname = "pleat.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}
    target: EnumProperty(items=[("SHAPE_KEYS", "Shape keys", "One for each frame"),
                                ("PC2", "Point cache", "A .pc2 file and a mesh that plays it"),
                                ("ALEMBIC", "Alembic", "An .abc file")])
    filepath: StringProperty(subtype="FILE_PATH")

    @classmethod
    def poll(cls, context):
        return rig_of(context) is not None

    def invoke(self, context, event):
        if self.target == "SHAPE_KEYS":
            return self.execute(context)
        ending = ".pc2" if self.target == "PC2" else ".abc"
        self.filepath = bpy.path.ensure_ext(rig_of(context).name, ending)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def steps(self, context):
        if self.target != "SHAPE_KEYS" and not self.filepath:
            raise PleatError("INVALID_ARGUMENT", "choose a file")
        panel, scene = _panel(context), context.scene
        work = bake.Bake(context, rig_of(context), scene.frame_start, scene.frame_end)
        panel.status = "baking"
        try:
            while work.step():
                panel.fraction = work.fraction
                yield
        finally:
            work.restore()
        path = bpy.path.abspath(self.filepath)
        try:
            if self.target == "SHAPE_KEYS":
                bake.to_shape_keys(work)
            elif self.target == "PC2":
                bake.to_point_cache(work, path)
            else:
                bake.to_alembic(work, path)
        except OSError as error:
            raise PleatError("FAILED_PRECONDITION", f"{path}: {error.strerror}") from error
        panel.status, panel.fraction = f"baked {len(work.positions)} frames", 1


class PLEAT_OT_refresh(bpy.types.Operator):
    """Forget the known poses and ask for this frame again, after keys of other frames were edited"""
    bl_idname = "pleat.refresh"
    bl_label = "Refresh"

    @classmethod
    def poll(cls, context):
        return live.find(rig_of(context)) is not None

    def execute(self, context):
        live.refresh(rig_of(context), clear=True)
        return {"FINISHED"}


CLASSES = (PLEAT_OT_connect, PLEAT_OT_download, PLEAT_OT_open, PLEAT_OT_train, PLEAT_OT_train_file, PLEAT_OT_cancel,
           PLEAT_OT_bake, PLEAT_OT_refresh)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    if _training is not None:
        _training.cancel()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
