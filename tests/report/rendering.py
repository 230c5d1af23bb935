"""One section of a page, as it is rendered."""

import spirob.report
from spirob.report.sections import discover

SECTIONS = {section.name: section for section in discover()}
RIG = [s for s in discover("rig") if s.name in ("verdict", "repairs")]


def text(name, data):
    return rendered(SECTIONS[name], data)


def rendered(section, data):
    context = section.get_context(data)
    if why := section.absent(context):
        return why
    return spirob.report._environment().get_template(section.template).render(context)
