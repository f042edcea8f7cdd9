# SPDX-License-Identifier: MIT
"""libvpl from Python, by ctypes: no compiler, and NumPy only if it is there.

    import vpl
    picture = vpl.render("room.json", method="keller", particles=1000, size=(320, 180))

A picture is a float32 array of shape (height, width, 3): linear radiance in W/(m^2 sr), row 0 at the top.
Without NumPy it is a memoryview of the same shape. Options are those of `vpl render`, with _ for -.
"""
import ctypes
import os
import warnings

try:
    import numpy
except ImportError:
    numpy = None

VERSION = (0, 12)  # of the headers that the structures below repeat
_LAYERS = {"picture": 0, "direct": 1, "indirect": 2, "albedo": 4, "normal": 8, "depth": 16, "object": 32}
_RESULTS = {1: KeyboardInterrupt, 2: MemoryError, 3: ValueError, 4: ValueError, 5: OSError, 6: ValueError}
_LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p)
_PROGRESS = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_double)


class _ContextDef(ctypes.Structure):
    _fields_ = [("alloc", ctypes.c_void_p), ("allocUser", ctypes.c_void_p), ("log", _LOG),
                ("logUser", ctypes.c_void_p), ("workerCount", ctypes.c_int), ("isa", ctypes.c_int),
                ("parallelFor", ctypes.c_void_p), ("parallelForUser", ctypes.c_void_p), ("cookie", ctypes.c_uint32)]


class _PixelsDef(ctypes.Structure):
    _fields_ = [("first", ctypes.c_void_p), ("format", ctypes.c_int), ("pixelStride", ctypes.c_ssize_t),
                ("rowStride", ctypes.c_ssize_t), ("exposure", ctypes.c_float), ("tonemap", ctypes.c_int),
                ("cookie", ctypes.c_uint32)]


class _Target(ctypes.Structure):
    _fields_ = [("layer", ctypes.c_int), ("pixels", _PixelsDef)]


def _find_library():
    here = os.path.dirname(os.path.abspath(__file__))
    installed = os.path.join(here, "libvpl.so")  # by wheel.py
    built = os.path.join(here, "..", "..", "..", "build", "libvpl.so")
    for path in (os.environ.get("VPL_LIBRARY"), installed, built):
        if path and os.path.exists(path):
            return path
    return "libvpl.so.%d.%d" % VERSION


def _load():
    library = ctypes.CDLL(_find_library())
    for name, result, arguments in (
            ("vplDefaultContextDef", _ContextDef, []),
            ("vplDefaultPixelsDef", _PixelsDef, []),
            ("vplContext_CreateForAbi", ctypes.c_int, "iipp"), ("vplContext_Destroy", None, "p"),
            ("vplContext_GetLastMessage", ctypes.c_char_p, "p"),
            ("vplScene_Load", ctypes.c_int, "psp"), ("vplScene_Destroy", None, "p"),
            ("vplRenderOptions_Create", ctypes.c_void_p, "p"), ("vplRenderOptions_Destroy", None, "pp"),
            ("vplRenderOptions_Set", ctypes.c_int, "pss"), ("vplRenderOptions_Get", ctypes.c_int, "pspz"),
            ("vplRenderOptions_GetProblem", ctypes.c_char_p, "p"),
            ("vplRenderOptions_SetProgress", None, "ppp"),
            ("vplRenderTo", ctypes.c_int, "pppipp"),
            ("vplImage_Create", ctypes.c_int, "piip"), ("vplImage_Destroy", None, "p"),
            ("vplImage_Write", ctypes.c_int, "psp")):
        types = {"p": ctypes.c_void_p, "i": ctypes.c_int, "s": ctypes.c_char_p, "z": ctypes.c_size_t}
        function = getattr(library, name)
        function.restype = result
        function.argtypes = [types[letter] for letter in arguments]
    return library


_library = _load()


@_LOG
def _log(_user, level, message):
    if level == 1:
        warnings.warn(message.decode(), stacklevel=2)


class Context:
    """Memory, threads and messages. One thread at a time may use it."""

    def __init__(self, threads=0):
        definition = _library.vplDefaultContextDef()
        definition.log = _log
        definition.workerCount = threads
        self.handle = ctypes.c_void_p()
        result = _library.vplContext_CreateForAbi(*VERSION, ctypes.byref(definition), ctypes.byref(self.handle))
        if result != 0:
            raise ImportError("libvpl has another version than %d.%d" % VERSION if result == 3 else "out of memory")

    def check(self, result):
        """Raises the exception that belongs to a result, with the library's sentence."""
        if result != 0:
            raise _RESULTS[result](_library.vplContext_GetLastMessage(self.handle).decode())

    def __del__(self):
        if getattr(self, "handle", None):
            _library.vplContext_Destroy(self.handle)


class _Options:
    """The library's options; words are those of the command line."""

    def __init__(self, context, options):
        self.context = context
        self.handle = ctypes.c_void_p(_library.vplRenderOptions_Create(context.handle))
        if not self.handle:
            raise MemoryError("out of memory")
        for name, value in options.items():
            if isinstance(value, (tuple, list)):
                value = "x".join(str(part) for part in value)
            if isinstance(value, bool):
                value = "on" if value else "off"
            if _library.vplRenderOptions_Set(self.handle, name.replace("_", "-").encode(), str(value).encode()) != 0:
                raise ValueError(_library.vplRenderOptions_GetProblem(self.handle).decode())

    def get(self, name):
        text = ctypes.create_string_buffer(256)
        self.context.check(_library.vplRenderOptions_Get(self.handle, name.encode(), text, len(text)))
        return text.value.decode()

    def __del__(self):
        if getattr(self, "handle", None):
            _library.vplRenderOptions_Destroy(self.context.handle, self.handle)


def _array(height, width, channels):
    """An array of floats, and the address of its first."""
    if numpy is not None:
        array = numpy.zeros((height, width, channels) if channels > 1 else (height, width), numpy.float32)
        return array, array.ctypes.data
    memory = (ctypes.c_float * (height * width * channels))()
    shape = (height, width, channels) if channels > 1 else (height, width)
    return memoryview(memory).cast("B").cast("f", shape), ctypes.addressof(memory)


class Scene:
    """A scene file: .json, or a model such as .obj."""

    def __init__(self, path, context=None):
        self.context = context or Context()
        self.handle = ctypes.c_void_p()
        self.context.check(_library.vplScene_Load(self.context.handle, os.fsencode(path), ctypes.byref(self.handle)))

    def render(self, layers=(), progress=None, **options):
        """Renders the picture; with layers such as ("depth", "albedo") a dict of the picture and them.

        progress(fraction) returns False to stop. Then, or after Ctrl-C, the picture so far comes back if there is one.
        """
        chosen = _Options(self.context, options)
        width, height = (int(number) for number in chosen.get("size").split("x"))
        names = ["picture"] + list(layers)
        targets = (_Target * len(names))()
        arrays = {}
        for target, name in zip(targets, names):
            channels = 1 if name in ("depth", "object") else 3
            arrays[name], address = _array(height, width, channels)
            target.layer = _LAYERS[name]
            target.pixels = _library.vplDefaultPixelsDef()
            target.pixels.first = address
            target.pixels.format = 0 if channels == 3 else 4
        failure = []

        @_PROGRESS
        def goes_on(_user, fraction):
            try:  # an exception must not pass through C
                return progress is None or progress(fraction) is not False
            except BaseException as error:
                failure.append(error)
                return False

        _library.vplRenderOptions_SetProgress(chosen.handle, ctypes.cast(goes_on, ctypes.c_void_p), None)
        passes = ctypes.c_int()
        result = _library.vplRenderTo(self.handle, chosen.handle, targets, len(targets), ctypes.byref(passes), None)
        if failure and not isinstance(failure[0], KeyboardInterrupt):
            raise failure[0]
        if result != 1 or passes.value == 0:
            self.context.check(result)
        return arrays if layers else arrays["picture"]

    def __del__(self):
        if getattr(self, "handle", None):
            _library.vplScene_Destroy(self.handle)


def render(scene, layers=(), progress=None, **options):
    """Renders a file or a Scene: vpl.render("room.json", method="keller", particles=1000)."""
    return (scene if isinstance(scene, Scene) else Scene(scene)).render(layers, progress, **options)


def write(picture, path):
    """Writes a picture to a .png, .hdr, .pfm or .exr file."""
    class Image(ctypes.Structure):
        _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("pixels", ctypes.POINTER(ctypes.c_float)),
                    ("context", ctypes.c_void_p)]

    context, handle = Context(), ctypes.c_void_p()
    height, width = picture.shape[:2]
    context.check(_library.vplImage_Create(context.handle, width, height, ctypes.byref(handle)))
    image = ctypes.cast(handle, ctypes.POINTER(Image)).contents
    values = picture.astype("f4").tobytes() if hasattr(picture, "astype") else picture.tobytes()
    ctypes.memmove(image.pixels, values, width * height * 12)
    try:
        context.check(_library.vplImage_Write(handle, os.fsencode(path), None))
    finally:
        _library.vplImage_Destroy(handle)
