#!/usr/bin/python3
"""The notebook of doc/notebook runs as it is, and its rendering shows what it holds."""

import importlib.machinery
import importlib.util
import os
import re
import tempfile
import unittest

import nbformat

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
FOLDER = os.path.join(ROOT, "doc", "notebook")


def script(name):
    path = os.path.join(ROOT, "scripts", name)
    loader = importlib.machinery.SourceFileLoader(name, path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def texts(notebook):
    """What the cells print and return, one text a cell."""
    return [
        "".join(
            output.text if output.output_type == "stream" else output.data["text/plain"]
            for output in cell.get("outputs", [])
            if output.output_type in ("stream", "execute_result")
        )
        for cell in notebook.cells
    ]


def without_rounding(text):
    """Numbers that are nothing but rounding, and another on every machine, as 0."""
    return re.sub(r"\b\d+(\.\d+)?e-1[5-9]\b", "0", text)


class NotebookTest(unittest.TestCase):
    def test_rounding_is_told_from_numbers(self):
        self.assertEqual(without_rounding("closes to 4e-16, 1.25e-05"), "closes to 0, 1.25e-05")

    def test_runs_and_is_rendered(self):
        render_notebook = script("render_notebook")
        with tempfile.TemporaryDirectory() as folder:
            notebook = render_notebook.execute(folder)
            out = os.path.join(folder, "out")
            os.mkdir(out)
            render_notebook.render(notebook, out)
            rendered = sorted(os.listdir(out))
        self.assertEqual(rendered, sorted(os.listdir(FOLDER)))
        self.assertEqual(len([name for name in rendered if name.endswith(".png")]), 3)
        with open(os.path.join(FOLDER, "recording.md"), encoding="utf-8") as file:
            text = file.read()
        kept = nbformat.read(os.path.join(FOLDER, "recording.ipynb"), as_version=4)
        self.assertEqual(len(notebook.cells), len(kept.cells))
        for made, shown in zip(texts(notebook), texts(kept)):
            self.assertEqual(without_rounding(made), without_rounding(shown))
            self.assertIn(shown.strip().replace("\n", "\n    "), text)
        for cell in notebook.cells:
            self.assertIn(cell.source, text, "scripts/render_notebook has not been run since the notebook was changed")
            for output in cell.get("outputs", []):
                self.assertIn(output.output_type, ("stream", "display_data", "execute_result"))
                self.assertNotEqual(output.get("name"), "stderr", output)


if __name__ == "__main__":
    unittest.main()
