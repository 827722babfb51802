"""Pleat in Blender: characters with learned folds are trained on a server and posed here (docs/guide/blender.md)."""

bl_info = {  # of Blender before 4.2; later ones read blender_manifest.toml
    "name": "Pleat",
    "author": "The Pleat authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Pleat",
    "description": "Characters with learned folds: train, pose, bake",
    "category": "Animation",
}

from . import library  # noqa: E402: bl_info stands first


def register():
    library.evaluating()  # a library that does not load or is of another version is refused with words
    from . import live, operators, panels, properties
    for module in (properties, operators, panels, live):
        module.register()


def unregister():
    from . import live, models, operators, panels, properties
    for module in (live, panels, operators, properties):
        module.unregister()
    models.forget()
