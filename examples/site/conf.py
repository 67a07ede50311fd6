"""How Sphinx builds this site: offline, every cell run, every warning an error (with -W)."""

import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE / "extensions"), str(ROOT)]
# Cells run in other processes, which have to import the package of this checkout.
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))

# The build does not touch the user's profile, and hides messages of kernels about their transport.
PROFILE = Path(tempfile.mkdtemp(prefix="geomtorsion-site-"))
atexit.register(shutil.rmtree, PROFILE, ignore_errors=True)
(PROFILE / "profile_default").mkdir()
(PROFILE / "profile_default/ipython_kernel_config.py").write_text(
    'c = get_config()\nc.IPKernelApp.log_level = "ERROR"\n'
    'c.IPKernelApp.matplotlib = "inline"\nc.InlineBackend.figure_formats = ["svg"]\n',
    "utf-8",
)
os.environ["IPYTHONDIR"] = str(PROFILE)

import geomtorsion as gt  # noqa: E402  # the one of this checkout

project = "geomtorsion"
author = "The geomtorsion authors"
copyright = author
version = release = gt.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "formulas",
    "docstrings",
    "reference",
    "gallery",
    "tables",
    "classroom",
    "laws",
    "notebooks",
    "steps",
    "topics",
]
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext"}
exclude_patterns = ["extensions", "style"]
suppress_warnings = ["misc.highlighting_failure"]
# A link that leads nowhere is a warning, but for names of other packages.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!geomtorsion\b).*")]

nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_output_stderr = "error"
nb_code_prompt_show = "Show the answer"
nb_code_prompt_hide = "Hide the answer"
nb_merge_streams = True
nb_render_markdown_format = "myst"
myst_enable_extensions = ["dollarmath", "deflist", "attrs_inline", "colon_fence"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
# Otherwise every array would be documented by the whole union of types that numpy accepts.
autodoc_type_aliases = {"ArrayLike": "ArrayLike"}
autodoc_default_options = {"members": True}
add_module_names = False
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = f"geomtorsion {release}"
html_math_renderer = "mathml"
html_static_path = ["style"]
html_favicon = "style/favicon.svg"
html_css_files = ["formulas.css", "site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"footer_icons": []}
pygments_style = "friendly"

# Copy what can be run: not the prompts, and no output.
copybutton_selector = "div:not(.output) > div.highlight > pre"
copybutton_prompt_text = r">>> |\.\.\. "
copybutton_prompt_is_regexp = True
