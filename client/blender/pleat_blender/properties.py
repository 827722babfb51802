"""What the add-on keeps: preferences, and the settings of an armature."""

import uuid

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty)

from . import armature, live
from .library import PleatError


def preferences(context=None):
    return (context or bpy.context).preferences.addons[__package__].preferences


class PleatPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    address: StringProperty(name="Server", default="127.0.0.1:7320", description="HOST:PORT, or unix:PATH")
    token: StringProperty(name="Token", subtype="PASSWORD", description="The text of a token, where the server asks for "
                                                                         "one. It is not written into .blend files")

    def draw(self, context):
        self.layout.prop(self, "address")
        self.layout.prop(self, "token")


_quiet = False  # while a property is set that shall start nothing


def set_quietly(settings, name, value):
    global _quiet
    _quiet = True
    try:
        setattr(settings, name, value)
    finally:
        _quiet = False


def _changed_live(settings, context):
    if _quiet:
        return
    rig = settings.id_data
    if not settings.live:
        live.stop(rig)
        return
    try:
        live.start(rig, preferences(context))
    except PleatError as error:
        settings.problem = str(error)
        set_quietly(settings, "live", False)
    else:
        settings.problem = ""


def _changed_source(settings, context):
    if settings.live and not _quiet:
        _changed_live(settings, context)


def _changed_look(settings, context):
    if not settings.show_heat and settings.mesh is not None:
        armature.show_colors(settings.mesh, None)
    live.refresh(settings.id_data)


class PleatSettings(bpy.types.PropertyGroup):
    """Of an armature that is a character."""

    key: StringProperty()  # of this armature, whatever its name is
    model_id: StringProperty(name="Model")
    model_path: StringProperty(name="File", subtype="FILE_PATH")
    address: StringProperty(name="Server", description="Where the model was trained", update=_changed_source)
    mesh: PointerProperty(name="Mesh", type=bpy.types.Object)
    problem: StringProperty()

    live: BoolProperty(name="Live folds", description="Show the detailed mesh while posing and playing",
                       update=_changed_live)
    source: EnumProperty(
        name="From", update=_changed_source, default="PROCESS",
        items=[("PROCESS", "This process", "Evaluated here, without a server"),
               ("SERVER", "Server", "Asked from the server; skinning is shown while it is away")])
    content: EnumProperty(
        name="Sent", update=_changed_source, default="PARAMETERS",
        items=[("PARAMETERS", "Parameters", "Under a kilobyte a frame; the mesh is made here"),
               ("MESH", "Mesh", "The whole mesh, compressed on a grid")])
    position_bits: IntProperty(name="Grid bits", default=16, min=8, max=20, update=_changed_source,
                               description="Of the mesh that is sent: 16 are about .02 mm on a person")
    strength: FloatProperty(name="Detail strength", default=1, min=0, soft_max=2, max=5, update=_changed_look,
                            description="0: skinning alone, 1: as learned, above: exaggerated")
    show_heat: BoolProperty(name="Confidence as colors", update=_changed_look,
                            description="A color attribute: blue like the training, red unknown")


def make_settings(rig, mesh, model_id, path="", address=""):
    settings = rig.pleat
    settings.key = uuid.uuid4().hex
    settings.model_id, settings.model_path, settings.mesh = model_id, path, mesh
    set_quietly(settings, "address", address)
    return settings


class PleatModelItem(bpy.types.PropertyGroup):
    """A model of the server, in the list of the panel."""

    model_id: StringProperty()
    label: StringProperty()
    learner: StringProperty()


class PleatScene(bpy.types.PropertyGroup):
    """What the panel of the scene shows."""

    models: bpy.props.CollectionProperty(type=PleatModelItem)
    model_index: IntProperty()
    learner: EnumProperty(
        name="Learner", default="auto",
        items=[("auto", "Best", "Chosen on held-out frames"), ("regional", "Regional", "One learner per body region"),
               ("regional-fast", "Regional, fast", "The same, trained in less time"), ("gp", "GP", "One Gaussian process"),
               ("sgplvm", "Shared GPLVM", "The paper's"), ("ridge", "Linear", "Linear regression")])
    status: StringProperty()
    fraction: FloatProperty(min=0, max=1, subtype="FACTOR", name="")


CLASSES = (PleatPreferences, PleatSettings, PleatModelItem, PleatScene)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.pleat = PointerProperty(type=PleatSettings)
    bpy.types.WindowManager.pleat = PointerProperty(type=PleatScene)


def unregister():
    del bpy.types.WindowManager.pleat
    del bpy.types.Object.pleat
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
