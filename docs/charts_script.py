"""Write the script of the charts of reports, `reports/templates/vega.js`, from the libraries that vl-convert contains.

    python docs/charts_script.py

The script is a file of the package, so that reports need no vl-convert: 84 MB for a script of 1 MB. `constraints.txt` has the
release of vl-convert that it is made with.
"""

from pathlib import Path

import vl_convert

#: The file.
FILE = Path(__file__).parents[1] / "reports" / "templates" / "vega.js"

#: The statement that the script executes after the libraries.
ENTRY = "window.vegaEmbed = vegaEmbed;"

#: The licence of the libraries, which asks to be kept with every copy.
LICENCE = """\
/*! Vega, Vega-Lite and Vega-Embed
Copyright (c) 2015-2025, University of Washington Interactive Data Lab
All rights reserved.

Redistribution and use in source and binary forms, with or without
modification, are permitted provided that the following conditions are met:

1. Redistributions of source code must retain the above copyright notice, this
   list of conditions and the following disclaimer.

2. Redistributions in binary form must reproduce the above copyright notice,
   this list of conditions and the following disclaimer in the documentation
   and/or other materials provided with the distribution.

3. Neither the name of the copyright holder nor the names of its contributors
   may be used to endorse or promote products derived from this software
   without specific prior written permission.

THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS"
AND ANY EXPRESS OR IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE
IMPLIED WARRANTIES OF MERCHANTABILITY AND FITNESS FOR A PARTICULAR PURPOSE ARE
DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDER OR CONTRIBUTORS BE LIABLE
FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL
DAMAGES (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR
SERVICES; LOSS OF USE, DATA, OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER
CAUSED AND ON ANY THEORY OF LIABILITY, WHETHER IN CONTRACT, STRICT LIABILITY,
OR TORT (INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN ANY WAY OUT OF THE USE
OF THIS SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE. */
"""


def script() -> str:
    """Return the script, which defines `vegaEmbed`, with the licence before it."""
    return f"{LICENCE}{vl_convert.javascript_bundle(ENTRY)}"


if __name__ == "__main__":
    FILE.write_text(script(), "utf-8", newline="\n")
