"""The panels in the sidebar of the 3D view."""

import bpy

from . import library, live, models, operators
from .library import PleatError
from .properties import preferences


class Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Pleat"


class CharacterSidebar(Sidebar):
    """What is shown where the armature of a character is chosen."""

    @classmethod
    def poll(cls, context):
        return operators.rig_of(context) is not None


def _say(layout, text, icon="NONE", width=46):
    """A text on as many lines as it needs."""
    line = ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            layout.label(text=line, icon=icon)
            line, icon = word, "BLANK1" if icon != "NONE" else "NONE"
        else:
            line = f"{line} {word}".strip()
    layout.label(text=line, icon=icon)


class PLEAT_UL_models(bpy.types.UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_property):
        layout.label(text=item.label)


class PLEAT_PT_server(Sidebar, bpy.types.Panel):
    bl_idname = "PLEAT_PT_server"
    bl_label = "Server"

    def draw(self, context):
        layout, panel, chosen = self.layout, context.window_manager.pleat, preferences(context)
        layout.prop(chosen, "address")
        layout.prop(chosen, "token")
        row = layout.row(align=True)
        row.operator("pleat.connect", icon="LINKED")
        row.operator("pleat.open", text="File", icon="FILE_FOLDER")
        if panel.models:
            layout.template_list("PLEAT_UL_models", "", panel, "models", panel, "model_index", rows=3)
            layout.operator("pleat.download", icon="IMPORT")


class PLEAT_PT_train(Sidebar, bpy.types.Panel):
    bl_idname = "PLEAT_PT_train"
    bl_label = "Train"

    def draw(self, context):
        layout, panel = self.layout, context.window_manager.pleat
        layout.prop(panel, "learner")
        row = layout.row(align=True)
        row.enabled = operators._training is None
        row.operator("pleat.train", text="This mesh", icon="MESH_DATA")
        row.operator("pleat.train_file", text="Files", icon="FILE_FOLDER")
        if panel.status:
            _say(layout, panel.status)
        if 0 < panel.fraction < 1:
            layout.prop(panel, "fraction", slider=True)
        if operators._training is not None:
            layout.operator("pleat.cancel", icon="CANCEL")


class PLEAT_PT_character(CharacterSidebar, bpy.types.Panel):
    bl_idname = "PLEAT_PT_character"
    bl_label = "Character"

    def draw(self, context):
        layout, rig = self.layout, operators.rig_of(context)
        settings = rig.pleat
        layout.prop(settings, "live", toggle=True, icon="PLAY")
        layout.prop(settings, "source", expand=False)
        if settings.source == "SERVER":
            layout.prop(settings, "address")
            layout.prop(settings, "content")
            if settings.content == "MESH":
                layout.prop(settings, "position_bits")
        layout.prop(settings, "strength", slider=True)
        layout.prop(settings, "show_heat")
        if settings.show_heat:
            layout.label(text="blue: seen, red: unknown", icon="COLOR")
        shown = live.find(rig)
        if settings.problem:
            _say(layout, settings.problem, "ERROR")
        elif shown is not None and shown.status:
            _say(layout, shown.status, "ERROR")
        elif shown is not None:
            layout.label(text=f"Confidence {shown.confidence:.2f}, {1000 * shown.seconds:.1f} ms")
        self._record(layout, settings)

    def _record(self, layout, settings):
        try:
            character = models.load(settings)
        except PleatError:
            return
        column = layout.column(align=True)
        column.label(text=f"Learner {character.learner}, {character.num_training_frames} frames")
        column.label(text=f"Skinned {character.skinned_mean_percent:.3f} %, {character.skinned_mean_mm:.2f} mm")
        column.label(text=f"With folds {character.detailed_mean_percent:.3f} %, {character.detailed_mean_mm:.2f} mm")
        for warning in character.warnings:
            _say(layout, warning, "INFO")


class PLEAT_PT_bake(CharacterSidebar, bpy.types.Panel):
    bl_idname = "PLEAT_PT_bake"
    bl_label = "Bake"

    def draw(self, context):
        column = self.layout.column(align=True)
        for target, text in (("SHAPE_KEYS", "Shape keys"), ("PC2", "Point cache"), ("ALEMBIC", "Alembic")):
            column.operator("pleat.bake", text=text).target = target
        self.layout.operator("pleat.refresh", icon="FILE_REFRESH")
        self.layout.label(text=f"Pleat {library.evaluating().version}")


CLASSES = (PLEAT_UL_models, PLEAT_PT_server, PLEAT_PT_train, PLEAT_PT_character, PLEAT_PT_bake)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
