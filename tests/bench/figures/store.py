"""What has been measured of one commit, in a JSON file under build/figures: a run that was stopped goes on there. Results of another commit, another
machine or another size are in other files, or not taken."""
import json
import os


class Store:
    def __init__(self, path, about):
        """`about`: commit, machine and sizes; what is there counts only where all of it is the same."""
        self.path, self.about, self.sections = path, about, {}
        try:
            with open(path, encoding="utf-8") as file:
                there = json.load(file)
            if there["about"] == about:
                self.sections = there["sections"]
        except (OSError, ValueError, KeyError, TypeError):
            pass  # nothing yet, or nothing that can be used: measured anew

    def get(self, name):
        return self.sections.get(name)

    def put(self, name, result):
        self.sections[name] = result
        os.makedirs(os.path.dirname(self.path) or ".", exist_ok=True)
        unfinished = self.path + ".unfinished"
        with open(unfinished, "w", encoding="utf-8") as file:
            json.dump({"about": self.about, "sections": self.sections}, file, indent=1)
        os.replace(unfinished, self.path)
